"""The manners of scikit-learn, without scikit-learn: parameters, copies, pipelines."""

import inspect
from typing import Any, Self


class Estimator:
    """Parameters are the keywords of the constructor, kept under their names; what `fit` finds ends in an underscore."""

    @classmethod
    def _parameters(cls) -> list[str]:
        return [name for name in inspect.signature(cls.__init__).parameters if name != "self"]

    def get_params(self, deep: bool = True) -> dict[str, Any]:  # noqa: ARG002, FBT001, FBT002 - as scikit-learn calls it
        """Return the parameters by name.

        Parameters
        ----------
        deep : bool, default True
            Not used: no parameter is an estimator.

        Returns
        -------
        dict
            From names to values.
        """
        return {name: getattr(self, name) for name in self._parameters()}

    def set_params(self, **params: Any) -> Self:
        """Set parameters by name.

        Parameters
        ----------
        **params
            Values that the constructor would take; `fit` checks them.

        Returns
        -------
        Estimator
            Itself.

        Raises
        ------
        ValueError
            If there is no parameter of a name.
        """
        known = self._parameters()
        for name, value in params.items():
            if name not in known:
                raise ValueError(f"set_params: expected names among {', '.join(known)}, got {name!r}")
            setattr(self, name, value)
        return self

    def __repr__(self) -> str:
        parameters = ", ".join(f"{name}={value!r}" for name, value in self.get_params().items())
        return f"{type(self).__name__}({parameters})"

    def __sklearn_is_fitted__(self) -> bool:
        """Tell scikit-learn whether `fit` was called."""
        return any(name.endswith("_") and not name.startswith("_") for name in vars(self))

    def __sklearn_tags__(self) -> Any:
        """Describe the estimator to scikit-learn, which alone asks."""
        from sklearn.utils import InputTags, Tags, TargetTags, TransformerTags  # noqa: PLC0415 - optional

        return Tags(
            estimator_type=None,
            target_tags=TargetTags(required=False),
            transformer_tags=TransformerTags(preserves_dtype=["float64", "float32"]),
            input_tags=InputTags(two_d_array=True, three_d_array=True, allow_nan=True),
        )


__all__ = ["Estimator"]

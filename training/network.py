"""Training of the network of gains, in NumPy: Adam on squared errors, with averaged weights."""

import sys
import time

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]

RATE, WARM_UP = 3e-3, 200
"""Learning rate, and steps in which it rises; after them it falls like a cosine."""

MOMENTS = (0.9, 0.999)
AVERAGE = 0.995
"""Share of the averaged weights that stays at each step."""

LARGE_ERROR = 0.1
"""Mean squared error of the pilot in a crop, in units of the variance of the noise, above which the crop counts less: its noise is not
white, the gain is large, and all others would hardly be seen beside it."""

LARGEST_GRADIENT = 1.0
"""Norm above which gradients are scaled down."""


class Network:
    """Two hidden layers of `units`, the second with a shortcut; matrices whose last row is the bias."""

    def __init__(self, inputs: int, units: int, outputs: int, rng: np.random.Generator) -> None:
        def layer(rows: int, columns: int, scale: float) -> Array:
            weights = np.zeros((rows + 1, columns), np.float32)
            weights[:-1] = scale / np.sqrt(rows) * rng.standard_normal((rows, columns))
            return weights

        # Without gains the result is the pilot.
        self.layers = [layer(inputs, units, 1.0), layer(units, units, 0.7), layer(units, outputs, 0.0)]

    def gains(self, inputs: Array) -> tuple[Array, list[Array]]:
        """Return the gains, and what their gradient needs."""
        first, second, last = self.layers
        one = inputs @ first[:-1] + first[-1]
        gate = sigmoid(one)
        hidden = one * gate
        two = hidden @ second[:-1] + second[-1]
        gate_two = sigmoid(two)
        top = hidden + two * gate_two
        return top @ last[:-1] + last[-1], [inputs, one, gate, hidden, two, gate_two, top]

    def gradient(self, seen: list[Array], of_gains: Array) -> list[Array]:
        """Return the gradient of the weights for that of the gains."""
        inputs, one, gate, hidden, two, gate_two, top = seen
        _, second, last = self.layers
        of_top = of_gains @ last[:-1].T
        of_two = of_top * gate_two * (1 + two * (1 - gate_two))
        of_one = (of_top + of_two @ second[:-1].T) * gate * (1 + one * (1 - gate))
        pairs = [(inputs, of_one), (hidden, of_two), (top, of_gains)]
        return [np.vstack([x.T @ of_y, of_y.sum(axis=0)]) for x, of_y in pairs]


def sigmoid(x: Array) -> Array:
    """Return `1 / (1 + exp(−x))`."""
    return 1 / (1 + np.exp(-np.maximum(x, -80)))


def train(
    gates: Array,
    basis: Array,
    target: Array,
    weight: Array,
    *,
    units: int,
    steps: int,
    batch: int,
    seed: int,
) -> list[Array]:
    """Return the weights of three layers, for gates that are not standardised."""
    rng = np.random.default_rng(seed)
    weight = weight * np.minimum(1, LARGE_ERROR * weight)
    sample = gates[rng.choice(len(gates), min(200_000, len(gates)), replace=False)].astype(np.float32)
    mean, deviation = sample.mean(axis=0), sample.std(axis=0) + 1e-3
    network = Network(gates.shape[1], units, basis.shape[1], rng)
    moments = [[np.zeros_like(layer), np.zeros_like(layer)] for layer in network.layers]
    averaged = [layer.copy() for layer in network.layers]
    of_pilot = float(np.mean(weight[:, None] * target**2))
    started, loss = time.monotonic(), of_pilot
    for step in range(steps):
        picked = np.sort(rng.integers(len(gates), size=batch))
        vectors = basis[picked].astype(np.float32)
        gains, seen = network.gains((gates[picked].astype(np.float32) - mean) / deviation)
        error = np.einsum("nk,nkt->nt", gains, vectors) - target[picked]
        weighted = weight[picked, None] * error
        loss += (float(np.mean(weighted * error)) - loss) * 0.01
        of_gains = np.einsum("nt,nkt->nk", weighted, vectors) * np.float32(2 / error.size)
        gradient = network.gradient(seen, of_gains)
        norm = np.sqrt(sum(float(np.sum(part**2)) for part in gradient))
        scale = np.float32(min(1.0, LARGEST_GRADIENT / max(norm, 1e-9)))
        rate = RATE * min(1, (step + 1) / WARM_UP) * (1 + np.cos(np.pi * step / steps)) / 2
        for i, part in enumerate(gradient):
            first, second = moments[i]
            moments[i][0] = first + (1 - MOMENTS[0]) * (scale * part - first)
            moments[i][1] = second + (1 - MOMENTS[1]) * ((scale * part) ** 2 - second)
            root = np.sqrt(moments[i][1] / (1 - MOMENTS[1] ** (step + 1))) + 1e-8
            network.layers[i] -= np.float32(rate / (1 - MOMENTS[0] ** (step + 1))) * moments[i][0] / root
            averaged[i] += (1 - AVERAGE) * (network.layers[i] - averaged[i])
        if (step + 1) % 1000 == 0:
            print(
                f"step {step + 1}: {loss / of_pilot:.4f} of the pilot's error, {time.monotonic() - started:.0f} s",
                file=sys.stderr,
            )
    # The first layer takes the gates as they are.
    first = averaged[0].astype(np.float64)
    first[:-1] /= deviation[:, None]
    first[-1] -= mean @ first[:-1]
    return [first.astype(np.float32), *(layer.astype(np.float32) for layer in averaged[1:])]

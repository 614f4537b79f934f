"""What a filter did to a motion: numbers, a text, a picture."""

from quatfilt.motion.report.measured import placed
from quatfilt.motion.report.report import Foot, Joint, Placed, Report, check_path, report

__all__ = ["Foot", "Joint", "Placed", "Report", "check_path", "placed", "report"]

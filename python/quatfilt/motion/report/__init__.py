"""What a filter did to a motion: numbers, a text, a picture."""

from quatfilt.motion.report.report import Foot, Joint, Report, check_path, report

__all__ = ["Foot", "Joint", "Report", "check_path", "report"]

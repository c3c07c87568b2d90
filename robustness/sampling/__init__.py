"""What random samples of a large network say about its robustness: a chance of error, and never a proof."""

from robustness.sampling.chance import chance_of_error
from robustness.sampling.front import sample_robustness
from robustness.sampling.results import SampleResult, SampleVerdict

__all__ = ["SampleResult", "SampleVerdict", "chance_of_error", "sample_robustness"]

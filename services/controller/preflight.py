"""What an operator should know of an experiment that may run."""

from hydrohil.services.controller.config import ControllerConfig
from hydrohil.services.controller.contact_environment import ContactEnvironment
from hydrohil.services.controller.limit_cycle import PROSPECTS, least_stable_n_per_m, prospect


def preflight(config: ControllerConfig, met: ContactEnvironment) -> tuple[str, ...]:
    """One line a warning."""
    if config.target != "impedance" or met.kind == "free":
        return ()
    return limit_cycle_warning(config.impedance.stiffness_n_per_m, config.impedance.environment_n_per_m, met.stiffness_n_per_m)


def limit_cycle_warning(stiffness_n_per_m: float, estimate_n_per_m: float, true_n_per_m: float) -> tuple[str, ...]:
    """The warning of a target that must or may limit-cycle by the controller's estimate of k_eff or by the true one."""
    assumed, real = prospect(stiffness_n_per_m, estimate_n_per_m), prospect(stiffness_n_per_m, true_n_per_m)
    worst = max(assumed, real, key=PROSPECTS.index)
    if worst == "cannot":
        return ()
    stable = least_stable_n_per_m(max(estimate_n_per_m, true_n_per_m))
    return (
        f"controller.impedance.stiffness_n_per_m is {stiffness_n_per_m:g} N/m: held in contact it {worst} limit-cycle "
        f"(k_eff {estimate_n_per_m:.5g} N/m as estimated: {assumed}, {true_n_per_m:.5g} N/m in truth: {real}); "
        f"it cannot from {stable:.5g} N/m on (thesis 7.1)",
    )

"""Claims about what vehicles do: carried out by the simulator."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations

import networkx as nx

from robustness.constructions.families import complete, wheel
from robustness.constructions.lemma_1 import profile
from robustness.digraph import Digraph, as_digraph
from robustness.gain_region import in_gain_region
from robustness.paper.audit.claims import Claim, Outcome, small_graphs, trapped
from robustness.paper.experiments import EXPERIMENTS, run_experiment
from robustness.simulation.adversaries import ADVERSARIES
from robustness.simulation.attacks import attack_from_trap
from robustness.simulation.gains import PromiseWarning
from robustness.simulation.motion import Withholding
from robustness.simulation.outcome import Outcome as RunOutcome
from robustness.simulation.outcome import RunVerdict
from robustness.simulation.run import simulate
from robustness.simulation.scenario import Scenario, Start, random_start
from robustness.simulation.schedules import schedule_named
from robustness.simulation.topology import Topology
from robustness.spelled import counted
from robustness.threat_models import tolerance

__all__ = ["CLAIMS", "battery", "runs_in_words"]

#: Adversaries under the malicious model, each against every malicious set of f nodes.
STRONGEST = ("constant", "ramp", "random", "two-face", "extreme", "greedy")
SCHEDULES = (("adversarial", 4), ("random", 4), ("delayed", 2))


def battery(graph: Digraph, f: int, *, steps: int = 600, seeds: int = 1) -> dict[str, int]:
    """Play every strong adversary with delays, in every set of f nodes, and count how the runs end.

    Returns
    -------
    dict
        ``"agreement"``, ``"split"``, ``"divergence"`` and ``"undecided"`` to numbers of runs. A run that is undecided
        is played once more, eight times as long.
    """
    starts = [
        random_start(graph, graph.labels_of(bad), seed)
        for bad in combinations(range(graph.n), f)
        for seed in range(seeds)
    ]
    counts = {"agreement": 0, "split": 0, "divergence": 0, "undecided": 0}
    for name in STRONGEST:
        for schedule, tau in SCHEDULES:
            scenario = Scenario(
                Topology((graph,)), f, "adp-msr", "malicious", ADVERSARIES[name](), schedule_named(schedule, tau), steps
            )
            outcomes = simulate(scenario, starts)
            pairs = zip(starts, outcomes, strict=True)
            again = [start for start, each in pairs if each.verdict is RunVerdict.UNDECIDED]
            settled = [each for each in outcomes if each.verdict is not RunVerdict.UNDECIDED]
            for outcome in [*settled, *simulate(replace(scenario, steps=8 * steps), again)]:
                counts[outcome.verdict.value] += 1
    return counts


def _necessity() -> Outcome:
    runs = 0
    for graph in small_graphs(5, 3):
        result = tolerance(graph, "malicious")
        attack = result.attack
        if attack is None:
            continue
        for rule in ("w-msr", "dp-msr", "adp-msr"):
            runs += 1
            if not attack.run(50, rule=rule).exact:
                return Outcome("fails", "simulation", f"{rule}: {attack.story()}", graph)
    return Outcome(
        "holds", "simulation: all graphs on 2 to 5 nodes, digraphs to 3", f"{counted(runs, 'run')}, all split exactly"
    )


def _sharper() -> Outcome:
    runs = 0
    for graph in small_graphs(5, 3):
        result = tolerance(graph, "delayed")
        for rule in ("w-msr", "adp-msr"):
            runs += 1
            if result.attack is None or not result.attack.run(50, rule=rule).exact:
                return Outcome("fails", "simulation", rule, graph)
    how = "simulation: a trap of every graph on 2 to 5 nodes, digraph to 3"
    return Outcome("holds", how, f"{counted(runs, 'run')}, all split exactly")


def _sufficiency() -> Outcome:
    graphs = [graph for graph in small_graphs(6, 2) if len(profile(graph)) > 3 and profile(graph)[3] >= 1]
    return _all_agree(graphs, f"the {len(graphs)} 3-robust graphs on 5 and 6 nodes")


def _no_trap() -> Outcome:
    """Graphs that only the exact condition promises: no trap, and not (2f+1)-robust."""
    graphs = []
    for graph in small_graphs(6, 2):
        table = profile(graph)
        if graph.n >= 4 and not trapped(graph, 1) and not (len(table) > 3 and table[3] >= 1):
            graphs.append(graph)
    return _all_agree(graphs, f"the {len(graphs)} graphs on 4 to 6 nodes without a trap that are not 3-robust")


def _all_agree(graphs: list[Digraph], which: str) -> Outcome:
    """Play every strong adversary in every vehicle on all graphs; the simulator's gains lie inside their region."""
    total = {"agreement": 0, "split": 0, "divergence": 0, "undecided": 0}
    for graph in graphs:
        for verdict, count in battery(graph, 1).items():
            total[verdict] += count
    how = f"simulation: {which}, f = 1, every adversary and malicious vehicle"
    broken = total["split"] + total["divergence"]
    return Outcome("holds" if graphs and not broken else "fails", how, runs_in_words(total))


def _any_positive_gain() -> Outcome:
    """K_2, nobody lies, alpha = 0.05; K_5, one liar, T = 0.01, alpha = 0.3 with delays of at most one step."""
    pair = Scenario(complete(2), 0, alpha=0.05, steps=300)
    case = EXPERIMENTS["push"].cases()[0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PromiseWarning)
        alone = simulate(pair, Start([], [0, 1], [0, 0]))[0]
        pushed = simulate(case.scenario, case.start)[0]
    fails = RunVerdict.DIVERGENCE in (alone.verdict, pushed.verdict)
    note = (
        f"two vehicles, nobody lies, T = 1, weights 1, alpha = 0.05: {alone.verdict.value} at step "
        f"{alone.diverged_at}. "
        f"K_5, which is 3-robust, f = 1, T = 0.01, weights 1, alpha = 0.3, delays 0 or 1: {pushed.verdict.value}. "
        f"Needed is "
        "s = sigma T² < 1 and 2 sqrt(s) - s/2 <= alpha T <= 2 - s/2, where kept weights add up to at most sigma"
    )
    return Outcome("fails" if fails else "holds", "simulation", note)


def _gain_region() -> Outcome:
    """Both sides of the region's border: the experiments on delays alone and on swapping."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PromiseWarning)
        results = [*run_experiment(EXPERIMENTS["gains-outside"]), *run_experiment(EXPERIMENTS["swap"])]
    right = all(each.as_reported for each in results)
    inside = sum(each.outcome.promise_gap is None for each in results)
    how = "simulation: experiments gains-outside and swap, nobody malicious"
    outside = counted(len(results) - inside, "run")
    note = f"{outside} outside diverge or swap for ever, {inside} inside with the same delays agree"
    return Outcome("holds" if right else "fails", how, note)


def runs_in_words(counts: dict[str, int]) -> str:
    """Return counts of runs in words."""
    return ", ".join(f"{count:,} {verdict}" for verdict, count in counts.items() if count) or "no run"


def _robust_at_every_step() -> Outcome:
    """Wheels on five vehicles whose hub changes at every step, in step: (2,2)-robust each, never the same links."""
    hubs = 5
    graphs = tuple(
        as_digraph(nx.Graph(((u + turn) % hubs, (v + turn) % hubs) for u, v in wheel(hubs).edges))
        for turn in range(hubs)
    )
    agreed = runs = 0
    for rule in ("w-msr", "dp-msr"):
        for name in STRONGEST:
            starts = [random_start(graphs[0], [v], seed) for v in range(hubs) for seed in range(2)]
            network = Topology(graphs, tuple(range(hubs)))
            scenario = Scenario(network, 1, rule, "malicious", ADVERSARIES[name](), steps=2000)
            runs += len(starts)
            agreed += sum(outcome.verdict.value == "agreement" for outcome in simulate(scenario, starts))
    robust_each = all(profile(graph)[2] >= 2 for graph in graphs)
    how = "simulation: wheels on 5 vehicles, another hub at each step, f = 1, W-MSR and DP-MSR, every adversary"
    return Outcome(
        "holds" if robust_each and agreed == runs else "fails", how, f"{agreed} of {counted(runs, 'run')} agree"
    )


def _exponential() -> Outcome:
    graph = as_digraph(complete(5))
    scenario = Scenario(
        Topology((graph,)), 1, "adp-msr", "malicious", ADVERSARIES["greedy"](), schedule_named("adversarial", 4), 1500
    )
    outcomes = simulate(scenario, [random_start(graph, [0], seed) for seed in range(10)])
    rates = [outcome.rate for outcome in outcomes if outcome.rate is not None]
    note = f"fitted factors per step from {min(rates):.3f} to {max(rates):.3f}" if rates else "no fit"
    result = "holds" if rates and max(rates) < 1 and len(rates) == len(outcomes) else "fails"
    return Outcome(result, "simulation: K_5, f = 1, greedy, delays to 4, 10 starts", note)


def _experiment(name: str) -> Callable[[], Outcome]:
    def check() -> Outcome:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PromiseWarning)
            results = run_experiment(EXPERIMENTS[name])
        told = [each for each in results if each.as_reported is not None]
        wrong = [each.case.name for each in told if not each.as_reported]
        how = f"simulation: experiment {name}, {counted(len(told), 'case')}"
        return Outcome("fails" if wrong else "holds", how, f"not as reported: {', '.join(wrong)}" if wrong else "")

    return check


def _absolute_reading() -> Outcome:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PromiseWarning)
        results = run_experiment(EXPERIMENTS["setting-1"])
    other = [each for each in results if each.as_reported is None]
    verdicts = ", ".join(f"{each.case.name}: {each.outcome.verdict.value}" for each in other)
    agrees = any(each.outcome.verdict.value == "agreement" for each in other)
    note = f"sent values must be read in the coordinate p; otherwise the split does not happen ({verdicts})"
    return Outcome("holds corrected" if agrees else "holds", "simulation: experiment setting-1", note)


def _gains() -> Outcome:
    """The example's T and alphas, with kept weights that add up to at most 1, and with unit weights on K_5."""
    gains = (2.0, 3.0, 10.0)
    even = [alpha for alpha in gains if in_gain_region(0.01, alpha, 1.0)]
    unit = [alpha for alpha in gains if in_gain_region(0.01, alpha, 3.0)]
    note = (
        f"kept weights up to 1: alpha = {', '.join(f'{each:g}' for each in even)} lie inside; weights of 1 on K_5 add "
        f"up to 3, and only alpha = {', '.join(f'{each:g}' for each in unit)} lies inside. The weights are not given"
    )
    return Outcome("holds corrected" if len(even) == 3 else "fails", "arithmetic", note)


def _truth_at_even_steps() -> Outcome:
    case = next(case for case in EXPERIMENTS["setting-2"].cases() if "says where it is" in case.reading)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PromiseWarning)
        outcome = simulate(case.scenario, case.start)[0]
    note = (
        "only claims of odd steps are given, and vehicles 1 and 5 update at even ones. They are split off if 200 is "
        "what "
        f"they go on hearing; if at even steps they hear where vehicle 4 is, the wheel ends in "
        f"{outcome.verdict.value} at "
        f"p = {outcome.groups[0][0]:.2f}"
    )
    agrees = outcome.verdict is RunVerdict.AGREEMENT
    return Outcome("holds corrected" if agrees else "holds", "simulation: experiment setting-2", note)


def _corollary_2_as_printed() -> Outcome:
    case = next(case for case in EXPERIMENTS["corollary-2"].cases() if "delays 2, tau = 2" in case.name)
    outcome = simulate(case.scenario, case.start)[0]
    note = (
        "K_5 in two halves (even steps without 03 and 12, odd ones without 02 and 13), f = 1, M = {4}, l = tau = 2, "
        "all "
        "delays 2: each vehicle uses one voice from the other side at a time, and drops it. True when "
        "(l-1) + (g-1) + b <= tau, with updates at most g apart and delays of at most b"
    )
    result = "fails" if outcome.exact else "holds"
    return Outcome(result, "simulation: experiment corollary-2, split exactly", note)


def _waiting_for_the_others() -> Outcome:
    """K_5, f = 1: each vehicle waits for 3 of its 4 neighbours, and the slow one is always an honest one."""
    heard = {0: (1, 4, 2), 1: (0, 4, 3), 2: (3, 4, 0), 3: (2, 4, 1), 4: (0, 1, 2, 3)}
    graph = Digraph(range(5), [(u, v) for v, senders in heard.items() for u in senders])
    attack = attack_from_trap(graph, 1, {4}, {0, 1}, {2, 3})
    splits = attack.run(200).exact
    note = (
        "d_i - f values always come, but a vehicle cannot tell a silent liar from a slow honest neighbour: in K_5 with "
        "f = 1 each vehicle may wait in vain for one of the other side, and is split. Missing values must be those of "
        "malicious vehicles, or come within tau"
    )
    return Outcome("holds corrected" if splits else "holds", "simulation: what is heard in K_5, split exactly", note)


def _withholding_and_lying() -> Outcome:
    """Liars that keep back half of their messages, at random, on K_5 and K_9 with f - m_i dropped on each side."""
    agreed = total = 0
    for f, n in ((1, 5), (2, 9)):
        graph = as_digraph(complete(n))
        for name in STRONGEST:
            liar = Withholding(ADVERSARIES[name]())
            scenario = Scenario(graph, f, adversary=liar, schedule=schedule_named("adversarial", 4), steps=2000)
            starts = [random_start(graph, range(k, k + f), k) for k in range(0, n - f + 1, f)]
            total += len(starts)
            agreed += sum(outcome.verdict is RunVerdict.AGREEMENT for outcome in simulate(scenario, starts))
    how = "simulation: K_5, f = 1 and K_9, f = 2, every adversary keeping back half of its messages"
    return Outcome("holds" if agreed == total else "fails", how, f"{agreed} of {counted(total, 'run')} agree")


def _all_see_for_themselves() -> Outcome:
    attack = tolerance(wheel(5), "delayed").attack
    assert attack is not None  # noqa: S101 - the wheel is trapped, see about_graphs
    outcome: RunOutcome = attack.run(200, active=frozenset(attack.graph.labels))
    note = (
        "the sentence before says that an attack stays possible, this one that it cannot prevent agreement. A vehicle "
        "that really jumps to and fro splits the wheel, with delays, although all others see it"
    )
    result = "contradicts itself" if outcome.exact else "holds"
    return Outcome(result, "simulation: the trap of the wheel, every vehicle active", note)


def _added_links() -> Outcome:
    graph = as_digraph(nx.complete_graph(6))
    thin = Digraph(graph.labels, [arc for arc in graph.arcs() if arc[0] != 0 or arc[1] < 3])
    scenario = Scenario(
        Topology((thin,)), 1, "adp-msr", "malicious", ADVERSARIES["extreme"](), schedule_named("adversarial", 4), 2000,
        added_links=tuple((0, v) for v in (3, 4, 5)),
    )  # fmt: skip
    outcomes = simulate(scenario, [random_start(thin, [0], seed) for seed in range(10)])
    agreed = sum(outcome.verdict.value == "agreement" for outcome in outcomes)
    robust = profile(thin)[3] >= 1
    result = "holds" if robust and agreed == len(outcomes) else "fails"
    how = "simulation: a 3-robust digraph, vehicle 0 adds links"
    return Outcome(result, how, f"{agreed} of {counted(len(outcomes), 'run')} agree")


def _omission() -> Outcome:
    agreed = total = 0
    for graph in small_graphs(6, 2):
        table = profile(graph)
        if len(table) > 3 and table[3] >= 1:
            starts = [random_start(graph, [v], seed) for v in graph.labels for seed in range(2)]
            scenario = Scenario(
                Topology((graph,)), 1, "adp-msr", "malicious", ADVERSARIES["omission"](),
                schedule_named("adversarial", 4), 2000,
            )  # fmt: skip
            outcomes = simulate(scenario, starts)
            total += len(outcomes)
            agreed += sum(outcome.verdict.value == "agreement" for outcome in outcomes)
    return Outcome(
        "holds" if agreed == total else "fails",
        "simulation: the 3-robust graphs on 5 and 6 nodes, each vehicle withholding messages",
        f"{agreed} of {counted(total, 'run')} agree",
    )


#: In the order of the paper.
CLAIMS: tuple[Claim, ...] = (
    Claim("Theorem 1, necessity", "a graph that is not (f+1,f+1)-robust is split", _necessity),
    Claim("Theorem 1, necessity", "the same on larger graphs", _experiment("necessity")),
    Claim(
        "Theorem 1, necessity",
        "sharper: a graph that is not (f+1)-robust without some f nodes is split under delays",
        _sharper,
        False,
    ),
    Claim("Section 3.1", "of the gains alpha_i nothing is asked but that they are positive", _any_positive_gain),
    Claim(
        "Theorem 1, sufficiency",
        "(2f+1)-robust graphs agree under delays, whatever the positive gains",
        _any_positive_gain,
    ),
    Claim("Theorem 1, sufficiency", "they agree when the gains lie in their region", _sufficiency, False),
    Claim("Theorem 1, sufficiency", "the same on larger graphs", _experiment("sufficiency"), False),
    Claim("Theorem 1, sufficiency", "the region of gains is exact", _gain_region, False),
    Claim(
        "Theorem 1, sufficiency",
        "sharper: graphs without a trap agree, and no others (gains in their region)",
        _no_trap,
        False,
    ),
    Claim("Theorem 1", "agreement is reached exponentially fast", _exponential),
    Claim("Theorem 1", "graphs between the conditions can be split", _experiment("gap")),
    Claim("Proposition 1", "ADP-MSR fails on the graph of four cliques, and on ours", _experiment("proposition-1")),
    Claim("Corollary 1", "(2f+1)-robust graphs agree under the f-local model", _experiment("corollary-1")),
    Claim(
        "before Corollary 2",
        "in step, (f+1,f+1)-robustness at every step is enough, for first and for second order",
        _robust_at_every_step,
    ),
    Claim("Corollary 2", "jointly (2f+1)-robust networks with l <= tau agree", _corollary_2_as_printed),
    Claim("Corollary 2", "they agree when (l-1) + (g-1) + b <= tau", _experiment("corollary-2"), False),
    Claim(
        "Section 3.2, omissive faults", "vehicles wait for d_i - f neighbours before an update", _waiting_for_the_others
    ),
    Claim("Section 3.2, omissive faults", "with 2(f - m_i) discarded, withheld messages do no harm", _omission),
    Claim("Section 3.2, omissive faults", "nor does withholding combined with lying", _withholding_and_lying, False),
    Claim("Section 3.2, added links", "extra links of a malicious vehicle do no harm", _added_links),
    Claim("Section 4, Setting 1", "the 5-node figure is split, K_5 agrees", _experiment("setting-1")),
    Claim("Section 4, Setting 1", "vehicle 4 sends 2 + kTr and 200 as positions", _absolute_reading),
    Claim("Section 4, Setting 2", "the same although vehicles 2 and 3 see vehicle 4", _experiment("setting-2")),
    Claim("Section 4, Setting 2", "vehicles 1 and 5 hear that vehicle 4 is at 200", _truth_at_even_steps),
    Claim("Section 4", "T = 0.01 and alpha = 2, 3, 10 lie where the theorem holds (needed, not said)", _gains, False),
    Claim(
        "Section 4, Setting 2",
        "when all vehicles see for themselves the malicious one cannot prevent agreement",
        _all_see_for_themselves,
    ),
)

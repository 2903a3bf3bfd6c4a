"""The table at the end of a benchmark run: every figure beside its target, and the ratios."""

from __future__ import annotations

import pytest

COLUMNS = "{:<58} {:>12} {:>12} {:>10}"


def shown(seconds: float) -> str:
    """Seconds in the unit in which they read best."""
    return f"{1e3 * seconds:.3f} ms" if seconds < 1 else f"{seconds:.2f} s"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Print what each benchmark measured, its target, and how far ahead of pyAgrum it is."""
    session = getattr(config, "_benchmarksession", None)
    found = [b for b in session.benchmarks if not b.has_error] if session else []
    if not found:
        return
    medians = {b.name: float(b.stats.median) for b in found}
    write = terminalreporter.write_line
    terminalreporter.section("palpate: figures and targets")
    write(COLUMNS.format("figure (median)", "found", "target", "verdict"))
    for bench in found:
        each = int(bench.extra_info.get("each", 1))
        seconds, target = medians[bench.name] / each, bench.extra_info.get("target_s")
        aim, verdict = (
            ("", "")
            if target is None
            else (shown(target), "met" if seconds <= target else f"{seconds / target:.1f} x over")
        )
        write(COLUMNS.format(bench.extra_info.get("what", bench.name), shown(seconds), aim, verdict))
        if each > 1:
            write(
                COLUMNS.format(
                    "  the same, per second", f"{1 / seconds:,.0f}", f"{1 / target:,.0f}" if target else "", ""
                )
            )
        least = bench.extra_info.get("least_s")
        if least is not None:
            write(
                COLUMNS.format(
                    "  the least, by bare calls in the same run", shown(least), "", f"{seconds / least:.1f} x"
                )
            )
        peak, most = bench.extra_info.get("peak_mb"), bench.extra_info.get("target_mb")
        if peak is not None:
            verdict = "met" if peak <= most else f"{peak / most:.1f} x over"
            write(COLUMNS.format("  peak of memory", f"{peak:.0f} MB", f"{most:.0f} MB", verdict))
    for bench in found:
        rival = bench.extra_info.get("rival")
        if rival in medians:
            ratio = medians[rival] / medians[bench.name]
            write(f"{bench.extra_info['what']}: {ratio:.1f} times as fast as pyAgrum with 64 bins")

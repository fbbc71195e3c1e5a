"""Faults of triggers and of settings: filters of effects, as those of moves in `effect_faults`.

Invariant: a filter is made anew for every run of a program.
"""

from __future__ import annotations

from dataclasses import replace
from typing import assert_never

from mitl.motion.task_run import EffectFilter
from rapid_interp import effects


def trigger_late(milliseconds: float) -> EffectFilter:
    """Gives a filter that makes triggers late."""

    def late(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.TriggerMove):
            return effect
        return replace(effect, triggers=tuple(replace(one, lag=one.lag - 1e-3 * milliseconds) for one in effect.triggers))

    return late


def trigger_missing(share: float) -> EffectFilter:
    """Gives a filter that loses triggers, evenly spread."""
    owed = 0.0

    def lost(effect: effects.Effect) -> effects.Effect:
        nonlocal owed
        if not isinstance(effect, effects.TriggerMove):
            return effect
        owed += share
        if owed < 1.0:
            return effect
        owed -= 1.0
        return effect.move

    return lost


def equip_lag_sign(share: float) -> EffectFilter:
    """Gives a filter that takes the time a device needs with the wrong sign."""

    def turned(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.TriggerMove):
            return effect
        return replace(effect, triggers=tuple(replace(one, lag=(1 - 2 * share) * one.lag) for one in effect.triggers))

    return turned


def analog_scale(per_cent: float) -> EffectFilter:
    """Gives a filter that makes analog outputs of triggers too large."""
    factor = 1 + per_cent / 100

    def scaled(action: effects.Action) -> effects.Action:
        match action:
            case effects.SetOutput(_, 0.0 | 1.0):
                return action  # a digital output, or one that makes no difference
            case effects.RampOutput() | effects.SetOutput():
                return replace(action, value=factor * action.value)
            case effects.FollowSpeed():
                return replace(action, scale=factor * action.scale)
            case effects.RaiseInterrupt() | effects.CheckSignal():
                return action
            case _:
                assert_never(action)

    def larger(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.TriggerMove):
            return effect
        return replace(effect, triggers=tuple(replace(one, action=scaled(one.action)) for one in effect.triggers))

    return larger


def acceleration_limits_ignored(share: float) -> EffectFilter:
    """Gives a filter that loses a share of what PathAccLim and AccSet take away; 1 is all of it."""

    def looser(limit: float | None) -> float | None:
        return None if limit is None or share >= 1 else limit / (1 - share)

    def ignored(effect: effects.Effect) -> effects.Effect:
        match effect:
            case effects.LimitPathAcceleration():
                return replace(effect, acceleration=looser(effect.acceleration), deceleration=looser(effect.deceleration))
            case effects.SetAcceleration():
                ramp = effect.ramp + share * (100 - effect.ramp)
                return replace(effect, acceleration=effect.acceleration + share * (100 - effect.acceleration), ramp=ramp)
            case _:
                return effect

    return ignored


def wrong_configuration(share: float) -> EffectFilter:
    """Gives a filter that takes a joint move for one that ends with the wrist turned over; a share below one half does nothing."""

    def turned(quarter: float) -> float:
        return quarter - 2 if quarter >= 0 else quarter + 2

    def flipped(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.MoveJ) or share < 0.5:
            return effect
        conf = effect.target.robconf
        over = replace(conf, cf4=turned(conf.cf4), cf6=turned(conf.cf6), cfx=float(round(conf.cfx) ^ 1))
        return replace(effect, target=replace(effect.target, robconf=over))

    return flipped


def configuration_ignored(share: float) -> EffectFilter:
    """Gives a filter that switches ConfL and ConfJ off for good; a share below one half does nothing."""

    def off(effect: effects.Effect) -> effects.Effect:
        return replace(effect, on=False) if isinstance(effect, effects.SetConfiguration) and share >= 0.5 else effect

    return off


def override_ignored(share: float) -> EffectFilter:
    """Gives a filter that loses a share of what VelSet takes away."""

    def faster(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.SetVelocity):
            return effect
        most = effect.max_tcp / (1 - share) if share < 1 else float("inf")
        return replace(effect, override=effect.override + share * (100 - effect.override), max_tcp=most)

    return faster


def displacement_ignored(share: float) -> EffectFilter:
    """Gives a filter that loses a share of the program displacement's shift."""

    def nearer(effect: effects.Effect) -> effects.Effect:
        if not isinstance(effect, effects.SetDisplacement):
            return effect
        trans = effect.displacement.trans
        left = replace(trans, x=(1 - share) * trans.x, y=(1 - share) * trans.y, z=(1 - share) * trans.z)
        return replace(effect, displacement=replace(effect.displacement, trans=left))

    return nearer


def sing_area_ignored(share: float) -> EffectFilter:
    """Gives a filter that takes every SingArea for Off; there is nothing between, so that a share below one half does nothing."""

    def off(effect: effects.Effect) -> effects.Effect:
        return replace(effect, mode="off") if isinstance(effect, effects.SetSingularity) and share >= 0.5 else effect

    return off

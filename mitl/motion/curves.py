"""Curves: the lines, arcs and turns of many Cartesian legs, evaluated together as arrays.

Invariant: what is given is what the legs give one by one; legs of other kinds have places here that nobody asks for.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from mitl.motion.legs import Arc, CartesianLeg, Leg, Line
from mitl.motion.orientation import EvenTurn, HeldWrist, evenly
from mitl.paths import BoolArray, FloatArray, IndexArray


class Curves:
    """Arrays over M legs."""

    def __init__(self, legs: Sequence[Leg]) -> None:
        count = len(legs)
        self._legs = legs
        self._origin, self._along, self._aside = np.zeros((3, count, 3))
        self._per_way = np.zeros(count)
        """1 / radius of arcs, 0 of lines."""
        self._rate, self._share = np.zeros((2, count))
        self._quaternion, self._turn = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)), np.zeros((count, 3))
        self._own: BoolArray = np.zeros(count, dtype=bool)
        """Legs that have to be asked themselves how the tool turns."""
        for index, leg in enumerate(legs):
            if not isinstance(leg, CartesianLeg):
                continue
            match leg.curve:
                case Line(p_start, direction, _):
                    self._origin[index], self._along[index] = p_start, direction
                case Arc(centre, radius, u, v):
                    self._origin[index], self._along[index], self._aside[index] = centre, radius * u, radius * v
                    self._per_way[index] = 1 / radius
            if leg.length > 0:
                self._rate[index], self._share[index] = leg.travel / leg.length, 1 / leg.length
            if isinstance(leg.turn, EvenTurn) and (leg.turn.law is evenly or leg.turn.turning == 0):
                self._quaternion[index], self._turn[index] = leg.turn.R_start.as_quat(), leg.turn.turn
            else:
                self._own[index] = not isinstance(leg.turn, HeldWrist)
        self._round = self._per_way > 0
        self._turns = (self._turn != 0).any(axis=1)

    def position(self, leg: IndexArray, x: FloatArray) -> FloatArray:
        """Gives TCP positions (N, 3) in m on legs (N,) at coordinates (N,)."""
        return self.position_after(leg, x * self._rate[leg])

    def position_after(self, leg: IndexArray, way: FloatArray) -> FloatArray:
        """Gives TCP positions (N, 3) in m on legs (N,) after ways (N,) in m."""
        position = self._origin[leg] + way[:, None] * self._along[leg]
        arcs = self._round[leg]
        if arcs.any():
            on = leg[arcs]
            angle = (way[arcs] * self._per_way[on])[:, None]
            position[arcs] = self._origin[on] + np.cos(angle) * self._along[on] + np.sin(angle) * self._aside[on]
        return position

    def tangent_after(self, leg: IndexArray, way: FloatArray) -> FloatArray:
        """Gives the TCP's unit tangents (N, 3) on legs (N,) after ways (N,) in m."""
        tangent = self._along[leg].copy()
        arcs = self._round[leg]
        if arcs.any():
            on = leg[arcs]
            angle = (way[arcs] * self._per_way[on])[:, None]
            tangent[arcs] = self._per_way[on][:, None] * (np.cos(angle) * self._aside[on] - np.sin(angle) * self._along[on])
        return tangent

    def quaternion(self, leg: IndexArray, x: FloatArray) -> FloatArray:
        """Gives the tool's orientations (N, 4), `xyzw`, on legs (N,) at coordinates (N,)."""
        quaternion = self._quaternion[leg]
        turning = self._turns[leg]
        if turning.any():
            on = leg[turning]
            turned = Rotation.from_rotvec((x[turning] * self._share[on])[:, None] * self._turn[on])
            quaternion[turning] = (Rotation.from_quat(quaternion[turning]) * turned).as_quat()
        own = self._own[leg]
        if own.any():
            for index in np.unique(leg[own]):
                here = np.flatnonzero(leg == index)
                asked = self._legs[index]
                assert isinstance(asked, CartesianLeg)  # noqa: S101 - only those are marked
                quaternion[here] = asked.rotation(x[here]).as_quat()
        return quaternion

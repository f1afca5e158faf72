# SPDX-License-Identifier: GPL-3.0-or-later
"""The turn of an environment texture around the vertical axis: Rotation Z of the Mapping node before it."""

from __future__ import annotations

from dataclasses import dataclass

from bpy.types import Node, NodeSocket

from ...core import locks
from ...core.journal import Journal
from ...core.value_slots import LazySlot, PropertySlot, ValueSlot
from . import owned, shaders
from .trails import NodeEntry, active_links, resolve

_ROTATION = "Vibe Rotation"


@dataclass
class EnvironmentTurnSlot:
    """Value slot: the angle by which the looked-up direction is turned, radians.

    A Mapping node of type Texture turns the other way round.
    """

    mapping: Node

    @property
    def locked(self) -> str:
        """Why the angle must be left alone."""
        origin = resolve(NodeEntry(self.mapping.inputs["Rotation"]))
        return locks.of_socket(origin.socket, origin.source)

    @property
    def _sign(self) -> float:
        return -1.0 if self.mapping.vector_type == "TEXTURE" else 1.0

    def get(self) -> float:
        """Radians."""
        return self._sign * self.mapping.inputs["Rotation"].default_value[2]

    def set(self, journal: Journal, raw: float) -> None:
        """Turns the environment."""
        PropertySlot(self.mapping.inputs["Rotation"], "default_value", index=2).set(journal, self._sign * raw)


def rotation_slot(background: shaders.NodeInGroups) -> ValueSlot | None:
    """The turn of the environment texture that a background comes from; None without one."""
    texture = shaders.environment(background.node.inputs["Color"])
    if not texture:
        return None
    vector = texture.node.inputs["Vector"]

    def find() -> ValueSlot | None:
        links = active_links(vector)
        node = links[0].from_node if links else None
        return EnvironmentTurnSlot(node) if node and node.bl_idname == "ShaderNodeMapping" else None

    def make(journal: Journal) -> ValueSlot:
        tree = vector.id_data
        mapping = journal.node(tree, "ShaderNodeMapping", _ROTATION)
        owned.dress(journal, tree, mapping, texture.node)
        owned.insert(
            journal, _direction_source(journal, vector, mapping), mapping, "Vector", vector, "Vector"
        )
        return EnvironmentTurnSlot(mapping)

    existing = find()
    return existing or LazySlot(find, make, 0.0, locks.of_socket(vector, None))


def _direction_source(journal: Journal, vector: NodeSocket, mapping: Node) -> NodeSocket:
    links = active_links(vector)
    if links:
        return links[0].from_socket
    node = journal.node(vector.id_data, "ShaderNodeTexCoord", "Vibe Direction")
    node.parent = mapping.parent
    node.location = (mapping.location.x - node.width - 60.0, mapping.location.y)
    return node.outputs["Generated"]

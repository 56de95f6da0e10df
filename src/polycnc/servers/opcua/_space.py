"""Put types and objects into the address space of a server, from their tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from asyncua import Server, ua
from asyncua.server.address_space import AddressSpace, NodeManagementService

from polycnc.servers.opcua import _cnc as cnc
from polycnc.servers.opcua import _machine_tool as tool
from polycnc.servers.opcua._cnc import POSITION, POSITION_NUMBERS
from polycnc.servers.opcua._model import (
    CNC,
    COMPONENT,
    MACHINERY,
    SPACES,
    Enumeration,
    Item,
    Member,
    Type,
    Unit,
)
from polycnc.servers.opcua._moment import PRODUCTION_STATES, Fixed
from polycnc.servers.opcua._tree import span_of, unit_of

_UNIT_SPACE = "http://www.opcfoundation.org/UA/units/un/cefact"
_VARIABLE, _PROPERTY, _DATA_ITEM, _ANALOG, _ANALOG_UNIT, _STATE = 63, 68, 2365, 2368, 17570, 2760
_HAS_PROPERTY, _SUBTYPE, _RULE, _ENCODING, _ORGANIZES = 46, 45, 37, 38, 35
_MANDATORY, _OPTIONAL = 78, 80
_STATES = {False: 2307, True: 2309}  # the types of a state, and of an initial one
_PARTS = ("ActPos", "CmdPos", "RemDist")
READ = ua.AccessLevel.CurrentRead.mask
READ_WRITE = READ | ua.AccessLevel.CurrentWrite.mask
_GONE = ua.StatusCode(ua.StatusCodes.BadNodeIdUnknown)
NOT_SUPPORTED = ua.StatusCode(ua.StatusCodes.BadNotSupported)


@ua.dataclass
class Position:
    """The structure of a position as it is sent."""

    data_type = ua.NodeId()
    ActPos: ua.Double = 0.0
    CmdPos: ua.Double = 0.0
    RemDist: ua.Double = 0.0


@dataclass(frozen=True, slots=True)
class Bound:
    """A member of an object, and its nodes: its own, and those of the parts of a position."""

    member: Member
    item: Item
    node: ua.NodeId
    parts: tuple[ua.NodeId, ...] = ()


class Space:
    """The address space of a server; `index` has the namespaces of the types."""

    def __init__(self, server: Server, index: Mapping[str, int]) -> None:
        self.index = {"": 0, **index}
        self._nodes: NodeManagementService = server.iserver.node_mgt_service
        self._space: AddressSpace = server.iserver.aspace
        self.own = 1
        """The namespace of this server, with the machines."""

    def register_position(self) -> None:
        """Make the structure of a position known to what sends and reads it."""
        space = self.index[CNC]
        data = ua.NodeId(POSITION_NUMBERS["data"], space)
        Position.data_type = data
        ua.register_extension_object(POSITION, ua.NodeId(POSITION_NUMBERS["binary"], space), Position, data)

    def has(self, node: ua.NodeId) -> bool:
        """Tell whether there is a node."""
        return node in self._space

    def node_of(self, of: Type) -> ua.NodeId:
        """Return the node of a type."""
        return ua.NodeId(of.number, self.index[of.space])

    # ------------------------------------------------------------------ types

    def add_types(self) -> None:
        """Add the types of both views: what is needed of the standards, with their numbers."""
        for enumeration in (*cnc.ENUMERATIONS, *tool.ENUMERATIONS):
            self._add_enumeration(enumeration)
        self._add_position_type()
        for each in (*cnc.TYPES, *tool.TYPES):
            self._add_type(each)
        machinery = self.index[MACHINERY]
        self.add_object(
            ua.NodeId(tool.MACHINES_NUMBER, machinery), ua.NodeId(85), "Machines", machinery, ua.NodeId(61),
            reference=_ORGANIZES,
        )  # fmt: skip
        for of, numbers in tool.STATE_NODES.items():
            space = self.index[of.space]
            for value, (number, name) in enumerate(zip(numbers, PRODUCTION_STATES, strict=True)):
                node, initial = ua.NodeId(number, space), ua.NodeId(_STATES[name == "Initializing"])
                self.add_object(node, self.node_of(of), name, space, initial)
                number_node = ua.NodeId(f"{of.name}.{name}.StateNumber", space)
                variant = ua.Variant(value, ua.VariantType.UInt32)
                self._property(number_node, node, "StateNumber", 0, variant, ua.NodeId(7))

    def _add_enumeration(self, row: Enumeration) -> None:
        space = self.index[row.space]
        node = ua.NodeId(row.number, space)
        attributes = ua.DataTypeAttributes(DisplayName=ua.LocalizedText(row.name), IsAbstract=False)
        fields = [
            ua.EnumField(Name=word, DisplayName=ua.LocalizedText(word), Value=value)
            for value, word in enumerate(row.words)
        ]
        attributes.DataTypeDefinition = ua.EnumDefinition(Fields=fields)
        self._add(node, ua.NodeId(29), row.name, space, ua.NodeClass.DataType, attributes, _SUBTYPE)
        words = ua.Variant([ua.LocalizedText(word) for word in row.words], ua.VariantType.LocalizedText)
        self._property(
            ua.NodeId(f"{row.name}.EnumStrings", space), node, "EnumStrings", 0, words, ua.NodeId(21), rank=1
        )

    def _add_position_type(self) -> None:
        space = self.index[CNC]
        data = ua.NodeId(POSITION_NUMBERS["data"], space)
        binary = ua.NodeId(POSITION_NUMBERS["binary"], space)
        attributes = ua.DataTypeAttributes(DisplayName=ua.LocalizedText(POSITION), IsAbstract=False)
        attributes.DataTypeDefinition = ua.StructureDefinition(
            DefaultEncodingId=binary,
            BaseDataType=ua.NodeId(22),
            StructureType=ua.StructureType.Structure,
            Fields=[
                ua.StructureField(Name=part, DataType=ua.NodeId(11), ValueRank=-1, IsOptional=False)
                for part in _PARTS
            ],
        )
        self._add(data, ua.NodeId(22), POSITION, space, ua.NodeClass.DataType, attributes, _SUBTYPE)
        self.add_object(binary, data, "Default Binary", 0, ua.NodeId(76), reference=_ENCODING)
        node = ua.NodeId(POSITION_NUMBERS["type"], space)
        kind = ua.VariableTypeAttributes(
            DisplayName=ua.LocalizedText("CncPositionVariableType"),
            DataType=data,
            ValueRank=-1,
            IsAbstract=False,
        )
        self._add(
            node, ua.NodeId(63), "CncPositionVariableType", space, ua.NodeClass.VariableType, kind, _SUBTYPE
        )
        for part in _PARTS:
            at = ua.NodeId(POSITION_NUMBERS[part], space)
            self._variable(at, node, part, space, ua.NodeId(11), ua.Variant(0.0), _VARIABLE, rule=_MANDATORY)
        for part, of in (("EngineeringUnits", 887), ("EURange", 884)):
            at = ua.NodeId(POSITION_NUMBERS[part], space)
            self._property(at, node, part, space, ua.Variant(None), ua.NodeId(of), rule=_MANDATORY)

    def _add_type(self, row: Type) -> None:
        space = self.index[row.space]
        node = self.node_of(row)
        base = self.node_of(row.base) if isinstance(row.base, Type) else ua.NodeId(row.base)
        attributes = ua.ObjectTypeAttributes(DisplayName=ua.LocalizedText(row.name), IsAbstract=row.abstract)
        self._add(node, base, row.name, space, ua.NodeClass.ObjectType, attributes, _SUBTYPE)
        for member in row.members:
            if "/" not in member.name:
                at = ua.NodeId(member.number or f"{row.name}.{member.name}", space)
                rule = _OPTIONAL if member.optional else _MANDATORY
                self._add_member(at, node, member, space, rule=rule)

    # ------------------------------------------------------------------ objects

    def add_items(
        self, place: str, parent: ua.NodeId, name: str, items: Iterable[Item], fixed: Fixed
    ) -> list[Bound]:
        """Add the objects of a machine; `place` begins their node ids. Return their members."""
        bound: list[Bound] = []
        for item in items:
            path = item.path
            node = self.at(place, path)
            under = self.at(place, path.rpartition("/")[0]) if path else parent
            self.add_object(
                node, under, item.name or name, self.own if item.space is None else self.index[item.space],
                self.node_of(item.type),
                reference=item.by if path else _ORGANIZES,
            )  # fmt: skip
            bound += [self._bind(node, item, member, fixed) for member in item.type.all_members]
        return bound

    def at(self, place: str, path: str) -> ua.NodeId:
        """Return the node of an object of a machine."""
        return ua.NodeId(f"{place}/{path}".rstrip("/"), self.own)

    async def remove(self, node: ua.NodeId) -> None:
        """Remove an object with what hangs on it; whoever monitors something of it gets to know that it is gone."""
        inside = f"{node.Identifier}/"
        (owner,) = (each.NodeId for each in self._space[node].references if not each.IsForward)
        of_owner = self._space[owner].references
        of_owner[:] = [each for each in of_owner if each.NodeId != node]
        gone = [each for each in self._space.keys() if str(each.Identifier).startswith(inside)]  # noqa: SIM118
        for each in gone:
            value = self._space[each].attributes.get(ua.AttributeIds.Value)
            if value is not None and value.datachange_callbacks:
                await self._space.write_attribute_value(
                    each, ua.AttributeIds.Value, ua.DataValue(ua.Variant(None), _GONE)
                )
                for handle in list(value.datachange_callbacks):
                    self._space.delete_datachange_callback(handle)
        items = [ua.DeleteNodesItem(NodeId=each, DeleteTargetReferences=False) for each in (*gone, node)]
        for code in self._nodes.delete_nodes(ua.DeleteNodesParameters(NodesToDelete=items)):
            code.check()

    def _bind(self, owner: ua.NodeId, item: Item, member: Member, fixed: Fixed) -> Bound:
        node = ua.NodeId(f"{owner.Identifier}/{member.name}", self.own)
        parent = owner if "/" not in member.name else ua.NodeId(node.Identifier.rpartition("/")[0], self.own)
        space = self.index[_space_of(member, item.type)]
        self._add_member(
            node, parent, member, space, unit_of(member, item, fixed), span_of(member, item, fixed)
        )
        if member.data != POSITION:
            return Bound(member, item, node)
        parts = tuple(ua.NodeId(f"{node.Identifier}/{part}", self.own) for part in _PARTS)
        for part, at in zip(_PARTS, parts, strict=True):
            self._variable(at, node, part, self.index[CNC], ua.NodeId(11), ua.Variant(0.0), _VARIABLE)
        return Bound(member, item, node, parts)

    def add_object(
        self,
        node: ua.NodeId,
        parent: ua.NodeId,
        name: str,
        space: int,
        of: ua.NodeId,
        *,
        reference: int = COMPONENT,
    ) -> None:
        """Add an object."""
        attributes = ua.ObjectAttributes(DisplayName=ua.LocalizedText(name))
        self._add(node, parent, name, space, ua.NodeClass.Object, attributes, reference, of)

    def let_emit(self, node: ua.NodeId) -> None:
        """Let clients subscribe to the events of an object."""
        values = self._space[node].attributes[ua.AttributeIds.EventNotifier].value
        values.Value = ua.Variant(ua.EventNotifier.SubscribeToEvents.mask, ua.VariantType.Byte)

    # ------------------------------------------------------------------ one node

    def _add_member(
        self,
        node: ua.NodeId,
        parent: ua.NodeId,
        member: Member,
        space: int,
        unit: Unit | None = None,
        span: tuple[float, float] = (0.0, 0.0),
        *,
        rule: int = 0,
    ) -> None:
        variant, data = data_of(member, self.index)
        rank = 1 if member.array else -1
        name = member.name.rpartition("/")[2]
        value = ua.Variant(_empty(member), variant)
        if member.prop:
            self._property(node, parent, name, space, value, data, rank=rank, rule=rule)
        elif member.data == POSITION:
            of = ua.NodeId(POSITION_NUMBERS["type"], self.index[CNC])
            self._variable(node, parent, name, space, data, value, of, rule=rule)
        else:
            plain = _STATE if member.name == "CurrentState" else _VARIABLE
            in_cnc = space == self.index[CNC]
            kind = (_ANALOG if in_cnc else _ANALOG_UNIT) if member.unit else _DATA_ITEM if in_cnc else plain
            level = READ_WRITE if member.write else READ
            self._variable(node, parent, name, space, data, value, kind, rank=rank, level=level, rule=rule)
        if member.unit and unit is not None:
            own = self.index[CNC] if member.data == POSITION else 0
            self._property(
                ua.NodeId(f"{node.Identifier}/EngineeringUnits", node.NamespaceIndex), node, "EngineeringUnits",
                own, ua.Variant(_unit(unit), ua.VariantType.ExtensionObject), ua.NodeId(887),
            )  # fmt: skip
            self._property(
                ua.NodeId(f"{node.Identifier}/EURange", node.NamespaceIndex), node, "EURange",
                own, ua.Variant(ua.Range(*span), ua.VariantType.ExtensionObject), ua.NodeId(884),
            )  # fmt: skip

    def _property(
        self,
        node: ua.NodeId,
        parent: ua.NodeId,
        name: str,
        space: int,
        value: ua.Variant,
        data: ua.NodeId,
        *,
        rank: int = -1,
        rule: int = 0,
    ) -> None:
        self._variable(
            node, parent, name, space, data, value, _PROPERTY, rank=rank, reference=_HAS_PROPERTY, rule=rule
        )

    def _variable(
        self,
        node: ua.NodeId,
        parent: ua.NodeId,
        name: str,
        space: int,
        data: ua.NodeId,
        value: ua.Variant,
        of: ua.NodeId | int,
        *,
        rank: int = -1,
        level: int = READ,
        reference: int = COMPONENT,
        rule: int = 0,
    ) -> None:
        attributes = ua.VariableAttributes(
            DisplayName=ua.LocalizedText(name), DataType=data, Value=value, ValueRank=rank,
            ArrayDimensions=[0] if rank == 1 else None, AccessLevel=level, UserAccessLevel=level,
        )  # fmt: skip
        kind = ua.NodeId(of) if isinstance(of, int) else of
        self._add(node, parent, name, space, ua.NodeClass.Variable, attributes, reference, kind)
        if rule:
            item = ua.AddReferencesItem(
                SourceNodeId=node, ReferenceTypeId=ua.NodeId(_RULE), IsForward=True, TargetNodeId=ua.NodeId(rule),
                TargetNodeClass=ua.NodeClass.Object,
            )  # fmt: skip
            self._nodes.add_references([item])[0].check()

    def _add(
        self,
        node: ua.NodeId,
        parent: ua.NodeId,
        name: str,
        space: int,
        of_class: ua.NodeClass,
        attributes: Any,
        reference: int,
        of: ua.NodeId | None = None,
    ) -> None:
        item = ua.AddNodesItem(
            RequestedNewNodeId=node, ParentNodeId=parent, ReferenceTypeId=ua.NodeId(reference),
            BrowseName=ua.QualifiedName(name, space), NodeClass=of_class, NodeAttributes=attributes,
            TypeDefinition=of or ua.NodeId(),
        )  # fmt: skip
        self._nodes.add_nodes([item])[0].StatusCode.check()


_PLAIN = {
    "Boolean": 1, "UInt16": 5, "UInt32": 7, "Double": 11, "String": 12, "NodeId": 17, "LocalizedText": 21,
}  # fmt: skip
_ENUMERATIONS = {row.name: row for row in (*cnc.ENUMERATIONS, *tool.ENUMERATIONS)}


def data_of(member: Member, index: Mapping[str, int]) -> tuple[ua.VariantType, ua.NodeId]:
    """Return how values of a member are sent, and the node of its data type."""
    if member.data == POSITION:
        return ua.VariantType.ExtensionObject, ua.NodeId(POSITION_NUMBERS["data"], index[CNC])
    if (row := _ENUMERATIONS.get(member.data)) is not None:
        return ua.VariantType.Int32, ua.NodeId(row.number, index[row.space])
    number = _PLAIN[member.data]
    return ua.VariantType(number), ua.NodeId(number)


def words_of(member: Member) -> int | None:
    """Return how many words the enumeration of a member has; None if it is no enumeration."""
    row = _ENUMERATIONS.get(member.data)
    return None if row is None else len(row.words)


def _space_of(member: Member, of: Type) -> str:
    if member.space is not None:
        return member.space
    owner: Type | int = of
    while isinstance(owner, Type):
        if member in owner.members:
            return owner.space
        owner = owner.base
    return of.space


def _empty(member: Member) -> Any:
    if member.array:
        return []
    values = {"Boolean": False, "Double": 0.0, "String": "", "NodeId": ua.NodeId()}
    if member.data == "LocalizedText":
        return ua.LocalizedText("")
    return Position() if member.data == POSITION else values.get(member.data, 0)


def _unit(unit: Unit) -> ua.EUInformation:
    return ua.EUInformation(
        NamespaceUri=_UNIT_SPACE, UnitId=unit.number, DisplayName=ua.LocalizedText(unit.sign),
        Description=ua.LocalizedText(unit.name),
    )  # fmt: skip


__all__ = ["NOT_SUPPORTED", "SPACES", "Bound", "Position", "Space", "data_of", "words_of"]

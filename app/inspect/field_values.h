#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Values of fields as people read them.
namespace gs::app {

/// What the numbers of a field are in (VRML97 4.4.5); `none`: in nothing, or in what only its author knows.
enum class Unit : std::uint8_t { none, metres, radians, seconds, metres_a_second };
/// "m", "rad", "s", "m/s"; empty for none.
[[nodiscard]] std::string_view symbol_of(Unit unit);
/// Of a rotation, that of its angle.
[[nodiscard]] Unit unit_of(const vrml::NodeType& type, const vrml::InterfaceDeclaration& field);

/// Of an MF value, its elements; else 1.
[[nodiscard]] std::size_t element_count(const vrml::FieldValue& value);
/// One of them as a value of its own; the value itself where it is no list.
[[nodiscard]] vrml::FieldValue element_of(const vrml::FieldValue& value, std::size_t index);
/// The same list with another one in its place; false where the type is another one, or there is no such place.
[[nodiscard]] bool set_element(vrml::FieldValue& value, std::size_t index, const vrml::FieldValue& element);

/// On one line, as VRML97 text has it, nodes as their DEF names or types; only the first elements of a long list, and
/// the beginning of a long string. Costs the same however long they are.
[[nodiscard]] std::string value_text(const vrml::FieldValue& value, const vrml::SceneGraph& scene);
/// All of it, for one who is to change it: read_value makes the same value of it. Nothing: it is too long for a line.
[[nodiscard]] std::optional<std::string> editable_text(const vrml::FieldValue& value, const vrml::SceneGraph& scene);
/// "90 deg" of radians, with a tenth of a degree.
[[nodiscard]] std::string degrees_text(double radians);
/// Whether a time is meant as a date rather than as a span: from 1980 on.
[[nodiscard]] bool is_date(double seconds);
/// Of a time since 1970 its date and clock in UTC, "2026-11-23 08:30:00.25"; else the number of seconds.
[[nodiscard]] std::string time_text(double seconds);

}  // namespace gs::app

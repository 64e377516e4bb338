#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Human-readable values of fields.
namespace gs::app {

/// Unit of a field's numbers (VRML97 4.4.5); `none` for dimensionless or author-defined values.
enum class Unit : std::uint8_t { none, metres, radians, seconds, metres_a_second };
/// Returns "m", "rad", "s" or "m/s"; "" for none.
[[nodiscard]] std::string_view symbol_of(Unit unit);
/// Returns the unit of a field. For a rotation, this is the unit of its angle.
[[nodiscard]] Unit unit_of(const vrml::NodeType& type, const vrml::InterfaceDeclaration& field);

/// Returns one element as a value of its own, or the value itself if it is not a list.
[[nodiscard]] vrml::FieldValue element_of(const vrml::FieldValue& value, std::size_t index);
/// Replaces one element of a list. Returns false if the type differs or the index is out of range.
[[nodiscard]] bool set_element(vrml::FieldValue& value, std::size_t index, const vrml::FieldValue& element);

/// Formats a value as VRML97 text on one line; nodes appear as DEF name or type. Abbreviates long lists and strings.
/// The cost does not depend on their length.
[[nodiscard]] std::string value_text(const vrml::FieldValue& value, const vrml::SceneGraph& scene);
/// Formats a complete value for editing: read_value returns the same value. Returns nullopt if it is too long for a
/// line.
[[nodiscard]] std::optional<std::string> editable_text(const vrml::FieldValue& value, const vrml::SceneGraph& scene);
/// Formats radians as degrees with one decimal: "90 deg".
[[nodiscard]] std::string degrees_text(double radians);
/// Reports whether a time is a date rather than a duration: from 1980 on.
[[nodiscard]] bool is_date(double seconds);
/// Formats a date in UTC as "2026-11-23 08:30:00.25", or a duration in seconds.
[[nodiscard]] std::string time_text(double seconds);

}  // namespace gs::app

#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Formatting of field values for people.
namespace gs::app {

/// Unit of a field's numbers (VRML97 4.4.5). `none` means that the field has no unit, or that the author chooses it.
enum class Unit : std::uint8_t { none, metres, radians, seconds, metres_a_second };
/// Returns "m", "rad", "s", "m/s", or "" for Unit::none.
[[nodiscard]] std::string_view symbol_of(Unit unit);
/// Returns the unit of a field. For a rotation, returns the unit of its angle.
[[nodiscard]] Unit unit_of(const vrml::NodeType& type, const vrml::InterfaceDeclaration& field);

/// Returns one element of an MF value as an SF value. Returns an SF value unchanged.
[[nodiscard]] vrml::FieldValue element_of(const vrml::FieldValue& value, std::size_t index);
/// Replaces one element of an MF value. Returns false if the type of `element` differs or `index` is out of range.
[[nodiscard]] bool set_element(vrml::FieldValue& value, std::size_t index, const vrml::FieldValue& element);

/// Formats a value as VRML97 text on one line. A node appears as its DEF name or type. Long lists and strings are
/// abbreviated, so that the cost does not depend on their length.
[[nodiscard]] std::string value_text(const vrml::FieldValue& value, const vrml::SceneGraph& scene);
/// Formats a complete value for editing, so that read_value() returns the same value. Returns nullopt if the text is
/// too long for a line.
[[nodiscard]] std::optional<std::string> editable_text(const vrml::FieldValue& value, const vrml::SceneGraph& scene);
/// Converts radians to degrees and formats them with one decimal: "90 deg".
[[nodiscard]] std::string degrees_text(double radians);
/// Returns true if `seconds` is a date from 1980 on, and not a duration.
[[nodiscard]] bool is_date(double seconds);
/// Formats a date in UTC as "2026-11-23 08:30:00.25", or a duration in seconds.
[[nodiscard]] std::string time_text(double seconds);

}  // namespace gs::app

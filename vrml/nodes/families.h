#pragma once

#include "vrml/scene/node_type.h"

#include <span>

namespace gs::vrml {

// Rows of the node table, one function per family of node types. vrml/nodes/node_type_table.cpp joins them.
[[nodiscard]] std::span<const NodeRow> grouping_rows();
[[nodiscard]] std::span<const NodeRow> geometry_rows();
[[nodiscard]] std::span<const NodeRow> geometric_properties_rows();
[[nodiscard]] std::span<const NodeRow> appearance_rows();
[[nodiscard]] std::span<const NodeRow> lights_rows();
[[nodiscard]] std::span<const NodeRow> sensors_rows();
[[nodiscard]] std::span<const NodeRow> interpolators_rows();
[[nodiscard]] std::span<const NodeRow> bindables_rows();
[[nodiscard]] std::span<const NodeRow> common_rows();
// Rows of the browser as a node. They are not part of the table.
[[nodiscard]] std::span<const NodeRow> browser_rows();

}  // namespace gs::vrml

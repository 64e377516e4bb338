#pragma once

#include "app/control/control_client.h"
#include "app/control/json_values.h"
#include "app/session/session.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {

class Control;
struct ServiceRow;

/// A call of a service: what it is given, and what it leads to. The readers of parameters say in `problem` what was
/// expected where they give nothing.
struct ServiceCall {
  Control& control;
  Session& session;
  ControlClient& client;
  const ServiceRow& row;
  std::vector<std::optional<std::string_view>> given;  // texts of JSON, by place in the row
  Document* document = nullptr;                        // null: no world has come, yet
  View* view = nullptr;                                // of that world, in the client's viewport
  std::string_view id = {};                            // of the call; empty: it wants no answer

  std::string result = "{}";  // JSON
  std::string problem = {};
  bool changes = false;        // what is seen may be another
  bool answers_later = false;  // or has done so

  [[nodiscard]] bool has(std::size_t place) const { return given[place].has_value(); }
  [[nodiscard]] std::optional<PlacedNode> node(std::size_t place);
  [[nodiscard]] std::optional<std::string> text(std::size_t place);
  [[nodiscard]] std::optional<std::vector<std::string>> texts(std::size_t place);
  [[nodiscard]] std::optional<std::size_t> whole(std::size_t place, std::size_t least, std::size_t most);
  /// As many finite numbers as there is room for.
  [[nodiscard]] bool numbers(std::size_t place, std::span<float> to);
  /// Of one scene of the world, of which the nodes are; null and no nodes for an empty list.
  [[nodiscard]] std::optional<std::pair<vrml::SceneGraph*, vrml::MFNode>> nodes(std::size_t place);
  /// `[node, eventIn, value]`, with the cursor behind the bracket that opens.
  [[nodiscard]] std::optional<ClientEvent> event(JsonCursor& json);
  [[nodiscard]] std::optional<ClientEvent> event(const PlacedNode& node, const std::string& event_in, JsonCursor& json);
  /// Reads a node, by its number or name, and goes behind it.
  [[nodiscard]] std::optional<PlacedNode> read_node(JsonCursor& json);
  /// `why` about a parameter.
  void fail_at(std::size_t place, const std::string& why);
  /// Appends values whose nodes are of a scene.
  void append(std::string& out, const vrml::FieldValue& value, vrml::SceneGraph& scene);
  /// Sends events, as one cascade of one timestamp, or keeps them for endUpdate.
  bool send(std::vector<ClientEvent>&& events);
  bool deliver(std::vector<ClientEvent>&& events);
};

/// The kinds of parameters, as the documentation calls them.
struct ParameterRow {
  std::string_view name;  // empty: no more
  std::string_view type;
  bool may_lack = false;
};

/// One service, as ISO/IEC 14772-2 names it where it has it: the row from which calls, their errors, `getServices` and
/// docs/control.md are made.
struct ServiceRow {
  std::string_view name;
  std::array<ParameterRow, 4> parameters;
  std::string_view result;  // JSON; empty: nothing but that it was done
  std::string_view help;
  bool needs_world = false;
  bool (*run)(ServiceCall& call) = nullptr;  // false: `problem` says why not
};

// A list a file.
[[nodiscard]] std::span<const ServiceRow> browser_services();
[[nodiscard]] std::span<const ServiceRow> node_services();
[[nodiscard]] std::span<const ServiceRow> view_services();
/// All of them.
[[nodiscard]] const std::vector<const ServiceRow*>& all_services();
/// Null: there is none of this name.
[[nodiscard]] const ServiceRow* find_service(std::string_view name);
[[nodiscard]] std::size_t parameter_count(const ServiceRow& row);
/// The table of docs/control.md.
[[nodiscard]] std::string services_as_markdown();

}  // namespace gs::app

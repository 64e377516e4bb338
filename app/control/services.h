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

/// Call of a service, with its parameters and its result. The functions that read parameters set `problem` to the
/// expected form if they return nothing.
struct ServiceCall {
  Control& control;
  Session& session;
  ControlClient& client;
  const ServiceRow& row;
  std::vector<std::optional<std::string_view>> given;  // JSON texts, by position in the row
  Document* document = nullptr;                        // null if no world is loaded yet
  View* view = nullptr;                                // view of `document` in the client's viewport
  std::string_view id = {};                            // id of the call; empty for a notification

  std::string result = "{}";  // JSON
  std::string problem = {};
  bool changes = false;        // the picture may change
  bool answers_later = false;  // the answer is sent later, or was already sent

  [[nodiscard]] bool has(std::size_t place) const { return given[place].has_value(); }
  [[nodiscard]] std::optional<PlacedNode> node(std::size_t place);
  [[nodiscard]] std::optional<std::string> text(std::size_t place);
  [[nodiscard]] std::optional<std::vector<std::string>> texts(std::size_t place);
  [[nodiscard]] std::optional<std::size_t> whole(std::size_t place, std::size_t least, std::size_t most);
  /// Reads exactly to.size() finite numbers.
  [[nodiscard]] bool numbers(std::size_t place, std::span<float> to);
  /// Reads nodes of one scene of the world, and that scene. An empty list gives null and no nodes.
  [[nodiscard]] std::optional<std::pair<vrml::SceneGraph*, vrml::MFNode>> nodes(std::size_t place);
  /// Reads `[node, eventIn, value]`, with the cursor after the opening bracket.
  [[nodiscard]] std::optional<ClientEvent> event(JsonCursor& json);
  [[nodiscard]] std::optional<ClientEvent> event(const PlacedNode& node, const std::string& event_in, JsonCursor& json);
  /// Reads a node by its number or name, and moves past it.
  [[nodiscard]] std::optional<PlacedNode> read_node(JsonCursor& json);
  /// Sets `problem` to an error about a parameter.
  void fail_at(std::size_t place, const std::string& why);
  /// Appends a field value; its nodes belong to `scene`.
  void append(std::string& out, const vrml::FieldValue& value, vrml::SceneGraph& scene);
  /// Sends events as one cascade with one timestamp, or stores them until endUpdate.
  bool send(std::vector<ClientEvent>&& events);
  bool deliver(std::vector<ClientEvent>&& events);
};

/// Parameter of a service, with its type as the documentation writes it.
struct ParameterRow {
  std::string_view name;  // empty after the last parameter
  std::string_view type;
  bool may_lack = false;
};

/// Service, named as in ISO/IEC 14772-2 where it exists there. Calls, their errors, `getServices` and docs/control.md
/// are made from these rows.
struct ServiceRow {
  std::string_view name;
  std::array<ParameterRow, 4> parameters;
  std::string_view result;  // JSON; empty if the result is only success
  std::string_view help;
  bool needs_world = false;
  bool (*run)(ServiceCall& call) = nullptr;  // returns false and sets `problem` on failure
};

// One list per file.
[[nodiscard]] std::span<const ServiceRow> browser_services();
[[nodiscard]] std::span<const ServiceRow> node_services();
[[nodiscard]] std::span<const ServiceRow> view_services();
/// Returns all services.
[[nodiscard]] const std::vector<const ServiceRow*>& all_services();
/// Returns the service of this name, or null.
[[nodiscard]] const ServiceRow* find_service(std::string_view name);
[[nodiscard]] std::size_t parameter_count(const ServiceRow& row);
/// Returns the table of docs/control.md.
[[nodiscard]] std::string services_as_markdown();

}  // namespace gs::app

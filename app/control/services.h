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

/// Call of a service, with its parameters and its result. If a function cannot read a parameter, it returns nullopt or
/// false, and sets `problem` to the expected form.
struct ServiceCall {
  Control& control;
  Session& session;
  ControlClient& client;
  const ServiceRow& row;
  std::vector<std::optional<std::string_view>> given;  // JSON texts of the parameters, in the order of `row`
  Document* document = nullptr;  // document of the client; null before its world is loaded
  View* view = nullptr;                                // view of `document` in the client's viewport
  std::string_view id = {};                            // id of the call; empty for a notification

  std::string result = "{}";  // JSON text
  std::string problem = {};
  bool changes = false;  // true if the call may change the picture
  bool answers_later = false;  // true if the answer follows later, or was sent already

  [[nodiscard]] bool has(std::size_t place) const { return given[place].has_value(); }
  [[nodiscard]] std::optional<PlacedNode> node(std::size_t place);
  [[nodiscard]] std::optional<std::string> text(std::size_t place);
  [[nodiscard]] std::optional<std::vector<std::string>> texts(std::size_t place);
  [[nodiscard]] std::optional<std::size_t> whole(std::size_t place, std::size_t least, std::size_t most);
  /// Reads exactly to.size() finite numbers from parameter `place`.
  [[nodiscard]] bool numbers(std::size_t place, std::span<float> to);
  /// Reads a list of nodes in one scene. Returns the scene and the nodes. An empty list gives null and no nodes.
  [[nodiscard]] std::optional<std::pair<vrml::SceneGraph*, vrml::MFNode>> nodes(std::size_t place);
  /// Reads the rest of `[node, eventIn, value]` after the opening bracket.
  [[nodiscard]] std::optional<ClientEvent> event(JsonCursor& json);
  [[nodiscard]] std::optional<ClientEvent> event(const PlacedNode& node, const std::string& event_in, JsonCursor& json);
  /// Reads a node, given by its number or DEF name, and moves to its end.
  [[nodiscard]] std::optional<PlacedNode> read_node(JsonCursor& json);
  /// Sets `problem` to an error about the parameter at index `place`.
  void fail_at(std::size_t place, const std::string& why);
  /// Appends the JSON of a field value to `out`. Nodes in the value must belong to `scene`.
  void append(std::string& out, const vrml::FieldValue& value, vrml::SceneGraph& scene);
  /// Sends events as one cascade with one timestamp. Between beginUpdate and endUpdate, only stores them. Returns false
  /// and sets `problem` on failure.
  bool send(std::vector<ClientEvent>&& events);
  bool deliver(std::vector<ClientEvent>&& events);
};

/// Parameter of a service, with its type in the notation of the documentation.
struct ParameterRow {
  std::string_view name;  // empty in the rows after the last parameter
  std::string_view type;
  bool may_lack = false;
};

/// Service. Has the name of its counterpart in ISO/IEC 14772-2, if there is one. Calls, error messages, `getServices`
/// and docs/control.md are derived from these rows.
struct ServiceRow {
  std::string_view name;
  std::array<ParameterRow, 4> parameters;
  std::string_view result;  // JSON form; empty if success has no result
  std::string_view help;
  bool needs_world = false;
  bool (*run)(ServiceCall& call) = nullptr;  // executes the call; returns false and sets `problem` on failure
};

// Each of these lists of services is in a separate file.
[[nodiscard]] std::span<const ServiceRow> browser_services();
[[nodiscard]] std::span<const ServiceRow> node_services();
[[nodiscard]] std::span<const ServiceRow> view_services();
/// Returns all services.
[[nodiscard]] const std::vector<const ServiceRow*>& all_services();
/// Returns the service with this name, or null.
[[nodiscard]] const ServiceRow* find_service(std::string_view name);
[[nodiscard]] std::size_t parameter_count(const ServiceRow& row);
/// Returns the table of services in docs/control.md, as Markdown.
[[nodiscard]] std::string services_as_markdown();

}  // namespace gs::app

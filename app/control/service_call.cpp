#include "app/control/control.h"
#include "app/control/services.h"
#include "app/session/running/world_runtime.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace gs::app {
namespace {

constexpr std::size_t kMaxUpdate = std::size_t{16} << 20;  // max bytes of JSON until endUpdate

std::string in_quotes(std::string_view text) { return "'" + std::string(text.substr(0, 80)) + "'"; }

}  // namespace

void ServiceCall::fail_at(std::size_t place, const std::string& why) {
  problem = "parameter '" + std::string(row.parameters[place].name) + "': " + why;
}

std::optional<PlacedNode> ServiceCall::read_node(JsonCursor& json) {
  const vrml::Execution& execution = document->runtime->execution();
  const JsonKind kind = json.kind();
  if (kind == JsonKind::number) {
    const double number = json.number();
    const bool whole = number >= 1 && number < 9e15 && number == std::trunc(number);
    const auto found = whole ? client.nodes.find(static_cast<std::uint64_t>(number)) : client.nodes.end();
    if (found == client.nodes.end()) {
      problem = "unknown node number; expected a number from getNode";
    } else if (!execution.scenes().has(found->second.scene) || !found->second.scene->contains(found->second.id)) {
      problem = "the node no longer exists";
    } else {
      return found->second;
    }
    return std::nullopt;
  }
  if (kind != JsonKind::string) {
    problem = "expected a node: its number, or its DEF name";
    return std::nullopt;
  }
  std::string made;
  const std::string_view name = json.string(made);
  if (const vrml::NodeId named = control.find_name(client, name)) return PlacedNode{document->world.scene.get(), named};
  problem = "unknown node " + in_quotes(name) + "; expected a DEF name or Type#number";
  return std::nullopt;
}

std::optional<PlacedNode> ServiceCall::node(std::size_t place) {
  JsonCursor json(*given[place]);
  auto found = read_node(json);
  if (!found) fail_at(place, problem);
  return found;
}

std::optional<std::string> ServiceCall::text(std::size_t place) {
  JsonCursor json(*given[place]);
  if (json.kind() != JsonKind::string) {
    fail_at(place, "expected a string");
    return std::nullopt;
  }
  std::string made;
  return std::string(json.string(made));
}

std::optional<std::vector<std::string>> ServiceCall::texts(std::size_t place) {
  std::vector<std::string> all;
  JsonCursor json(*given[place]);
  std::string made;
  if (json.kind() == JsonKind::string) return std::vector<std::string>{std::string(json.string(made))};
  if (json.kind() == JsonKind::list) {
    json.open();
    while (json.more()) {
      if (json.kind() != JsonKind::string) {
        fail_at(place, "expected strings");
        return std::nullopt;
      }
      all.emplace_back(json.string(made));
    }
    return all;
  }
  fail_at(place, "expected a string or a list of strings");
  return std::nullopt;
}

std::optional<std::size_t> ServiceCall::whole(std::size_t place, std::size_t least, std::size_t most) {
  JsonCursor json(*given[place]);
  if (json.kind() == JsonKind::number)
    if (const double number = json.number();
        number >= static_cast<double>(least) && number <= static_cast<double>(most) && number == std::trunc(number))
      return static_cast<std::size_t>(number);
  fail_at(place, "expected a whole number from " + std::to_string(least) +
                     (most == std::numeric_limits<std::size_t>::max() ? " on" : " to " + std::to_string(most)));
  return std::nullopt;
}

bool ServiceCall::numbers(std::size_t place, std::span<float> to) {
  JsonCursor json(*given[place]);
  std::size_t count = 0;
  if (json.kind() == JsonKind::list) {
    json.open();
    for (; json.more() && count <= to.size() && json.kind() == JsonKind::number; ++count) {
      const double number = json.number();
      if (count == to.size() || !std::isfinite(static_cast<float>(number))) break;
      to[count] = static_cast<float>(number);
    }
  }
  if (count == to.size()) return true;
  fail_at(place, "expected a list of " + std::to_string(to.size()) + " numbers");
  return false;
}

std::optional<std::pair<vrml::SceneGraph*, vrml::MFNode>> ServiceCall::nodes(std::size_t place) {
  JsonCursor json(*given[place]);
  std::pair<vrml::SceneGraph*, vrml::MFNode> all{nullptr, {}};
  if (json.kind() != JsonKind::list) {
    fail_at(place, "expected a list of nodes");
    return std::nullopt;
  }
  json.open();
  while (json.more()) {
    const auto one = read_node(json);
    if (one && all.first && all.first != one->scene) problem = "expected nodes of one file";
    if (!one || (all.first && all.first != one->scene)) {
      fail_at(place, problem);
      return std::nullopt;
    }
    all.first = one->scene;
    all.second.push_back(one->id);
  }
  return all;
}

void ServiceCall::append(std::string& out, const vrml::FieldValue& value, vrml::SceneGraph& scene) {
  append_json_value(out, value, [&](std::string& to, vrml::NodeId one) {
    to += scene.contains(one) ? std::to_string(control.number_of(client, scene, one)) : "null";
  });
}

// Events ------------------------------------------------------------------------------------------

std::optional<ClientEvent> ServiceCall::event(const PlacedNode& node, const std::string& event_in, JsonCursor& json) {
  const vrml::NodeType& type = *node.scene->node(node.id).type;
  ClientEvent event{node, type.find_event_in(event_in), {}};
  if (!event.event_in) {
    problem = type.name + " has no eventIn " + in_quotes(event_in);
    return std::nullopt;
  }
  // A field may refer only to nodes of its own scene.
  const ReadNode of_scene = [&](JsonCursor& from, std::string& why) -> std::optional<vrml::NodeId> {
    const auto found = read_node(from);
    if (found && found->scene == node.scene) return found->id;
    why = found ? "expected a node of the same file" : problem;
    return std::nullopt;
  };
  std::string why;
  auto value = read_json_value(json, event.event_in->type, of_scene, why);
  if (!value) {
    problem = type.name + "." + event.event_in->name + " is of " + std::string(vrml::name_of(event.event_in->type)) +
              ": " + why;
    return std::nullopt;
  }
  event.value = std::move(*value);
  return event;
}

std::optional<ClientEvent> ServiceCall::event(JsonCursor& json) {
  const char* const expected = "expected [node, eventIn, value]";
  std::string made;
  if (json.kind() != JsonKind::list) {
    problem = expected;
    return std::nullopt;
  }
  json.open();
  problem = expected;
  if (!json.more()) return std::nullopt;
  const auto node = read_node(json);
  if (!node) return std::nullopt;
  problem = expected;
  if (!json.more() || json.kind() != JsonKind::string) return std::nullopt;
  const std::string event_in(json.string(made));
  if (!json.more()) return std::nullopt;
  auto read = event(*node, event_in, json);
  if (!read || !json.more()) return read;
  problem = expected;
  return std::nullopt;
}

bool ServiceCall::send(std::vector<ClientEvent>&& events) {
  if (!client.updates) return deliver(std::move(events));
  for (const std::optional<std::string_view>& one : given) client.update_bytes += one ? one->size() : 0;
  if (client.update_bytes > kMaxUpdate) {
    problem = "an update exceeds " + std::to_string(kMaxUpdate >> 20) + " MiB; expected endUpdate earlier";
    return false;
  }
  // The nodes exist until endUpdate, because the client's numbers keep them alive.
  for (ClientEvent& event : events) client.update.push_back(std::move(event));
  return true;
}

bool ServiceCall::deliver(std::vector<ClientEvent>&& events) {
  vrml::Execution& execution = document->runtime->execution();
  execution.cascade().begin_update();
  std::size_t sent = 0;
  for (ClientEvent& event : events) {
    if (!execution.scenes().has(event.node.scene)) continue;
    if (execution.cascade().post(*event.node.scene, event.node.id, *event.event_in, std::move(event.value))) ++sent;
  }
  execution.cascade().drain();
  changes = true;
  if (sent == events.size()) return true;
  problem = std::to_string(events.size() - sent) + " of " + std::to_string(events.size()) +
            " events were not sent, because their nodes no longer exist or the limit of pending events is reached";
  return false;
}

// Table -------------------------------------------------------------------------------------------

const std::vector<const ServiceRow*>& all_services() {
  static const std::vector<const ServiceRow*> all = [] {
    std::vector<const ServiceRow*> rows;
    for (const auto list : {browser_services(), node_services(), view_services()})
      for (const ServiceRow& row : list) rows.push_back(&row);
    return rows;
  }();
  return all;
}

const ServiceRow* find_service(std::string_view name) {
  static const std::unordered_map<std::string_view, const ServiceRow*> by_name = [] {
    std::unordered_map<std::string_view, const ServiceRow*> rows;
    for (const ServiceRow* const row : all_services()) rows[row->name] = row;
    return rows;
  }();
  const auto found = by_name.find(name);
  return found == by_name.end() ? nullptr : found->second;
}

std::size_t parameter_count(const ServiceRow& row) {
  const auto end = std::find_if(row.parameters.begin(), row.parameters.end(),
                                [](const ParameterRow& one) { return one.name.empty(); });
  return static_cast<std::size_t>(end - row.parameters.begin());
}

std::string services_as_markdown() {
  std::string out = "| Service | Parameters | Result | |\n| --- | --- | --- | --- |\n";
  for (const ServiceRow* const row : all_services()) {
    out += "| `" + std::string(row->name) + "` | ";
    for (std::size_t i = 0; i < parameter_count(*row); ++i) {
      const ParameterRow& one = row->parameters[i];
      out += (i ? "<br>" : "") + ("`" + std::string(one.name)) + "`: " + std::string(one.type) +
             (one.may_lack ? " (optional)" : "");
    }
    out += " | " + (row->result.empty() ? std::string() : "`" + std::string(row->result) + "`") + " | " +
           std::string(row->help) + " |\n";
  }
  return out;
}

}  // namespace gs::app

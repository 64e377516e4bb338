#include "app/control/control.h"
#include "app/control/services.h"
#include "app/session/running/world_runtime.h"

#include <limits>

// Services for nodes and their events (ISO/IEC 14772-2 4.5 to 4.8).
namespace gs::app {
namespace {

constexpr ParameterRow kNode{"node", "node"};
constexpr ParameterRow kEventOut{"event", "name of an eventOut or exposedField"};
constexpr std::size_t kMaxWatches = 100'000, kMaxNodes = 1'000'000;  // max numbers of watches and of nodes per client

void put_node(ServiceCall& call, const PlacedNode& node) {
  const vrml::Node& of = node.scene->node(node.id);
  call.result = "{\"node\":" + std::to_string(call.control.number_of(call.client, *node.scene, node.id)) + ",\"type\":";
  append_json_string(call.result, of.type->name);
  call.result += ",\"name\":";
  append_json_string(call.result, of.name);
  call.result += '}';
}

bool get_node(ServiceCall& call) {
  const auto node = call.node(0);
  if (!node) return false;
  if (call.client.nodes.size() >= kMaxNodes) {
    call.problem = "this client has " + std::to_string(kMaxNodes) + " nodes; expected dispose earlier";
    return false;
  }
  put_node(call, *node);
  return true;
}

bool get_type(ServiceCall& call) {
  const auto node = call.node(0);
  if (!node) return false;
  call.result.clear();
  append_json_string(call.result, node->scene->node(node->id).type->name);
  return true;
}

bool get_interface(ServiceCall& call) {
  const auto node = call.node(0);
  if (!node) return false;
  std::string& out = call.result = "[";
  for (const vrml::InterfaceDeclaration& one : node->scene->node(node->id).type->interfaces) {
    out += out.size() > 1 ? ",{\"name\":" : "{\"name\":";
    append_json_string(out, one.name);
    out += ",\"access\":\"" + std::string(vrml::name_of(one.access)) + "\",\"type\":\"" +
           std::string(vrml::name_of(one.type)) + "\"}";
  }
  out += ']';
  return true;
}

bool dispose(ServiceCall& call) {
  const auto number = call.whole(0, 1, std::numeric_limits<std::int32_t>::max());
  if (!number) return false;
  call.control.dispose(call.client, *number);
  return true;
}

// Returns an eventOut. The first parameter is the node, the second the name of the eventOut. Returns null on failure.
const vrml::InterfaceDeclaration* event_out(ServiceCall& call, std::optional<PlacedNode>& node) {
  node = call.node(0);
  const auto name = node ? call.text(1) : std::nullopt;
  if (!name) return nullptr;
  const vrml::NodeType& type = *node->scene->node(node->id).type;
  const vrml::InterfaceDeclaration* const found = type.find_event_out(*name);
  if (!found) call.fail_at(1, type.name + " has no eventOut '" + name->substr(0, 80) + "'");
  return found;
}

bool get_value(ServiceCall& call) {
  std::optional<PlacedNode> node;
  const vrml::InterfaceDeclaration* const event = event_out(call, node);
  if (!event) return false;
  const vrml::FieldValue* const value =
      call.document->runtime->execution().cascade().last_value(*node->scene, node->id, *event);
  if (!value) {
    call.problem = "the value exceeds the limit of pending events";
    return false;
  }
  call.result.clear();
  const vrml::FieldValue copy = *value;
  call.append(call.result, copy, *node->scene);
  return true;
}

bool set_value(ServiceCall& call) {
  const auto node = call.node(0);
  const auto name = node ? call.text(1) : std::nullopt;
  if (!name) return false;
  JsonCursor json(*call.given[2]);
  auto event = call.event(*node, *name, json);
  if (!event) return false;
  std::vector<ClientEvent> one;
  one.push_back(std::move(*event));
  return call.send(std::move(one));
}

bool set_values(ServiceCall& call) {
  JsonCursor json(*call.given[0]);
  if (json.kind() != JsonKind::list) {
    call.fail_at(0, "expected a list of [node, eventIn, value]");
    return false;
  }
  json.open();
  std::vector<ClientEvent> events;
  while (json.more()) {
    auto one = call.event(json);
    if (!one) {
      call.fail_at(0, "event " + std::to_string(events.size() + 1) + ": " + call.problem + "; no event was sent");
      return false;
    }
    events.push_back(std::move(*one));
  }
  return call.send(std::move(events));
}

bool advise(ServiceCall& call) {
  std::optional<PlacedNode> node;
  const vrml::InterfaceDeclaration* const event = event_out(call, node);
  if (!event) return false;
  if (call.client.watches.size() >= kMaxWatches) {
    call.problem = "this client already watches " + std::to_string(kMaxWatches) + " eventOuts";
    return false;
  }
  call.result = "{\"watch\":" + std::to_string(call.control.watch(call.client, *node, *event)) + "}";
  return true;
}

bool unadvise(ServiceCall& call) {
  const auto number = call.whole(0, 1, std::numeric_limits<std::int32_t>::max());
  if (!number) return false;
  if (call.client.world && call.control.unwatch(call.client, *number)) return true;
  call.problem = "unknown watch number";
  return false;
}

constexpr ServiceRow kNodeServices[] = {
    {"getNode",
     {{{"node", "DEF name, or `Type#number` as in `trace`"}}},
     "{\"node\":1,\"type\":\"Transform\",\"name\":\"Box\"}",
     "returns a number for the node; the node stays in memory until `dispose` or until the client disconnects",
     true,
     get_node},
    {"getType", {{kNode}}, "string", "returns the name of the node type", true, get_type},
    {"getInterface",
     {{kNode}},
     "[{\"name\",\"access\",\"type\"},...]",
     "returns the fields and events in the order of the declaration",
     true,
     get_interface},
    {"dispose", {{{"node", "number of a node"}}}, "", "releases the number", true, dispose},
    {"getValue",
     {{kNode, kEventOut}},
     "value",
     "returns the value of an exposedField, or the last value of an eventOut (initially the zero of its type)",
     true,
     get_value},
    {"setValue",
     {{kNode, {"event", "name of an eventIn or exposedField"}, {"value", "value"}}},
     "",
     "sends an event and its whole cascade",
     true,
     set_value},
    {"setValues",
     {{{"events", "list of `[node, eventIn, value]`"}}},
     "",
     "sends events with one timestamp; if one is invalid, sends none",
     true,
     set_values},
    {"advise", {{kNode, kEventOut}}, "{\"watch\":1}", "subscribes to the values of the eventOut", true, advise},
    {"unadvise", {{{"watch", "number from `advise`"}}}, "", "ends `advise`", true, unadvise},
};

}  // namespace

std::span<const ServiceRow> node_services() { return kNodeServices; }

}  // namespace gs::app

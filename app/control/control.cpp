#include "app/control/control.h"

#include "app/session/running/world_runtime.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMaxSeen = 20'000;  // max number of watched events that are not sent yet
constexpr std::size_t kMaxId = 256;       // max length of the id of a call, in bytes

// Error codes of JSON-RPC 2.0, 5.1.
enum class RpcError : int {
  parse = -32700,
  invalid = -32600,
  no_method = -32601,
  parameters = -32602,
  failed = -32000
};

void append_error(std::string& out, std::string_view id, RpcError code, std::string_view why) {
  out += "{\"jsonrpc\":\"2.0\",\"id\":";
  out += id;
  out += ",\"error\":{\"code\":" + std::to_string(static_cast<int>(code)) + ",\"message\":";
  append_json_string(out, why);
  out += "}}";
}

std::uint64_t node_key(vrml::NodeId id) { return std::uint64_t{id.generation} << 32 | id.index; }

/// Call of JSON-RPC 2.0. `method` is nullopt if the call is invalid.
struct RpcCall {
  std::optional<std::string> method;
  std::string_view id, parameters;  // JSON texts; empty if the call has no such member
  std::string problem;
};

RpcCall read_call(JsonCursor& json) {
  RpcCall call;
  std::string made, version;
  if (json.kind() != JsonKind::object) {
    (void)json.skip();
    call.problem = "expected an object";
    return call;
  }
  json.open();
  while (json.more()) {
    const std::string name(json.name(made));
    const JsonKind kind = json.kind();
    if (name == "method" && kind == JsonKind::string) {
      call.method = std::string(json.string(made));
      continue;
    }
    const std::string_view text = json.skip();
    if (name == "id") {
      call.id = text;
      if (kind == JsonKind::list || kind == JsonKind::object || kind == JsonKind::boolean || text.size() > kMaxId)
        call.problem = "expected an id that is a number or a short string";
    } else if (name == "params") {
      call.parameters = text;
      if (kind != JsonKind::list && kind != JsonKind::object) call.problem = "expected params as a list or an object";
    } else if (name == "method") {
      call.problem = "expected the name of a method";
    } else if (name == "jsonrpc" && text != "\"2.0\"") {
      call.problem = "expected \"jsonrpc\": \"2.0\"";
    }
  }
  if (!call.method && call.problem.empty()) call.problem = "expected the name of a method";
  if (!call.problem.empty()) call.id = call.id.size() > kMaxId ? std::string_view() : call.id;
  return call;
}

// Reads the parameters of a call, by name or by position. Returns the error, or nullopt.
std::optional<std::string> take_parameters(std::string_view text, const ServiceRow& row,
                                           std::vector<std::optional<std::string_view>>& given) {
  const std::size_t count = parameter_count(row);
  given.assign(count, std::nullopt);
  if (!text.empty()) {
    JsonCursor json(text);
    const bool by_name = json.kind() == JsonKind::object;
    std::string made;
    json.open();
    for (std::size_t i = 0; json.more(); ++i) {
      std::size_t place = i;
      if (by_name) {
        const std::string name(json.name(made));
        for (place = 0; place < count && row.parameters[place].name != name;) ++place;
        if (place == count) return "unknown parameter '" + name.substr(0, 80) + "'";
      } else if (place >= count) {
        return "expected at most " + std::to_string(count) + " parameters";
      }
      given[place] = json.skip();
    }
  }
  for (std::size_t i = 0; i < count; ++i)
    if (!given[i] && !row.parameters[i].may_lack)
      return "expected parameter '" + std::string(row.parameters[i].name) + "': " + std::string(row.parameters[i].type);
  return std::nullopt;
}

}  // namespace

Control::Control(ControlChannel& channel, std::function<void()> wake, std::chrono::steady_clock::duration most_of_step)
    : channel_(channel), wake_(std::move(wake)), most_of_step_(most_of_step) {}

Control::~Control() {
  for (auto& [number, client] : clients_) leave_world(client);
  for (const auto& world : worlds_)
    if (const auto document = world->document.lock(); document && document->runtime)
      document->runtime->execution().cascade().observe({}, this);
}

// Steps -------------------------------------------------------------------------------------------

bool Control::act(Session& session) {
  changed_ = false;
  prune();
  for (auto& [number, client] : clients_) follow_viewport(session, client);
  tell_events();
  tell_late();
  const auto end = std::chrono::steady_clock::now() + most_of_step_;
  while (auto news = channel_.next()) {
    if (news->left) {
      if (const auto found = clients_.find(news->client); found != clients_.end()) drop(found->second);
      clients_.erase(news->client);
      continue;
    }
    ControlClient& client = clients_[news->client];
    client.number = news->client;
    follow_viewport(session, client);
    answer(session, client, news->message);
    if (std::chrono::steady_clock::now() < end) continue;
    if (wake_) wake_();
    break;
  }
  return changed_;
}

void Control::step_is_over() { tell_events(); }

// Removes the state of worlds that no longer exist, and that of their clients.
void Control::prune() {
  for (auto& [number, client] : clients_)
    if (client.world && client.world->document.expired()) {
      tell_browser_event(client, "shutdown", nullptr);
      leave_world(client);
    }
  std::erase_if(worlds_, [](const auto& world) { return world->document.expired(); });
}

void Control::follow_viewport(Session& session, ControlClient& client) {
  const std::vector<std::size_t> sight = session.panes().visible();
  const View* const view = client.viewport < sight.size() ? session.panes().at(sight[client.viewport]).view() : nullptr;
  std::shared_ptr<Document> document = view ? view->document : nullptr;
  if (document && (!document->runtime || !document->runtime->has_started())) document = nullptr;
  const std::shared_ptr<Document> before = client.world ? client.world->document.lock() : nullptr;
  if (before == document && (document || !client.world)) return;
  if (client.world) {
    tell_browser_event(client, "shutdown", before.get());
    leave_world(client);
  }
  if (!document) return;
  document->runtime->programs().measure_viewer();
  const auto known = std::find_if(worlds_.begin(), worlds_.end(),
                                  [&](const auto& world) { return world->document.lock() == document; });
  if (known != worlds_.end()) {
    client.world = known->get();
  } else {
    worlds_.push_back(std::make_unique<ControlledWorld>());
    worlds_.back()->document = document;
    client.world = worlds_.back().get();
  }
  tell_browser_event(client, "initialized", document.get());
  for (const std::string& id : std::exchange(client.waits_for_world, {}))
    channel_.send(client.number, "{\"jsonrpc\":\"2.0\",\"id\":" + id + ",\"result\":{}}");
}

void Control::tell_browser_event(ControlClient& client, std::string_view what, const Document* document) {
  if (!client.wants_browser_events) return;
  std::string out =
      "{\"jsonrpc\":\"2.0\",\"method\":\"browser\",\"params\":{\"event\":\"" + std::string(what) + "\",\"url\":";
  append_json_string(out, document && document->runtime ? document->runtime->programs().browser().world_url : "");
  out += "}}";
  channel_.send(client.number, std::move(out));
}

void Control::drop(ControlClient& client) { leave_world(client); }

void Control::leave_world(ControlClient& client) {
  if (!client.world) return;
  const auto document = client.world->document.lock();
  while (!client.watches.empty()) (void)unwatch(client, client.watches.begin()->first);
  if (document && document->runtime) {
    vrml::Execution& execution = document->runtime->execution();
    for (const auto& [number, node] : client.nodes)
      if (execution.scenes().has(node.scene)) execution.lifetime().release(*node.scene, node.id);
  }
  client.nodes.clear();
  client.known_nodes.clear();
  client.update.clear();
  client.update_bytes = 0;
  client.updates = false;
  client.late.clear();
  client.world = nullptr;
}

// Calls -------------------------------------------------------------------------------------------

void Control::answer(Session& session, ControlClient& client, const std::string& message) {
  std::string out;
  if (const auto problem = check_json(message)) {
    append_error(out, "null", RpcError::parse,
                 "not JSON: " + problem->why + " (byte " + std::to_string(problem->place + 1) + ")");
    channel_.send(client.number, std::move(out));
    return;
  }
  JsonCursor json(message);
  if (json.kind() != JsonKind::list) {
    answer_call(session, client, json, out);
  } else {
    json.open();
    bool any = false;
    while (json.more()) {
      any = true;
      const std::string_view one = json.skip();
      std::string single;
      answer_call(session, client, JsonCursor(one), single);
      if (!single.empty()) out += (out.empty() ? "[" : ",") + single;
    }
    if (!any) {
      append_error(out, "null", RpcError::invalid, "expected a call object");
    } else if (!out.empty()) {
      out += ']';
    }
  }
  tell_events();
  if (!out.empty()) channel_.send(client.number, std::move(out));
}

void Control::answer_call(Session& session, ControlClient& client, JsonCursor json, std::string& out) {
  const RpcCall asked = read_call(json);
  if (!asked.problem.empty() || !asked.method)
    return append_error(out, asked.id.empty() ? "null" : asked.id, RpcError::invalid, asked.problem);
  const auto fail = [&](RpcError code, const std::string& why) {
    if (!asked.id.empty()) return append_error(out, asked.id, code, why);
    // A call without id gets no answer. Its errors are sent as notifications, unless the client reads too slowly.
    if (channel_.is_behind(client.number)) return;
    std::string told = "{\"jsonrpc\":\"2.0\",\"method\":\"problem\",\"params\":{\"method\":";
    append_json_string(told, asked.method->substr(0, 80));
    told += ",\"message\":";
    append_json_string(told, why);
    channel_.send(client.number, told + "}}");
  };
  const ServiceRow* const row = find_service(*asked.method);
  if (!row) return fail(RpcError::no_method, "unknown service '" + asked.method->substr(0, 80) + "'; see getServices");
  ServiceCall call{*this, session, client, *row, {}};
  call.id = asked.id;
  if (const auto problem = take_parameters(asked.parameters, *row, call.given))
    return fail(RpcError::parameters, *problem);
  const std::shared_ptr<Document> document = client.world ? client.world->document.lock() : nullptr;
  if (document) {
    call.document = document.get();
    const std::vector<std::size_t> sight = session.panes().visible();
    call.view = session.panes().at(sight[std::min(client.viewport, sight.size() - 1)]).view();
  } else if (row->needs_world) {
    return fail(RpcError::failed, "no world is open yet; awaitWorld answers when one is");
  }
  const bool good = row->run(call);
  changed_ = changed_ || call.changes;
  if (document && call.changes) document->controlled = true;
  if (!good) return fail(RpcError::failed, call.problem);
  if (asked.id.empty() || call.answers_later) return;
  out += "{\"jsonrpc\":\"2.0\",\"id\":";
  out += asked.id;
  out += ",\"result\":";
  out += call.result;
  out += '}';
}

// Nodes -------------------------------------------------------------------------------------------

std::uint64_t Control::number_of(ControlClient& client, vrml::SceneGraph& scene, vrml::NodeId node) {
  const auto [known, is_new] = client.known_nodes.try_emplace(node_key(node), client.last_node + 1);
  if (!is_new) return known->second;
  const auto document = client.world->document.lock();
  document->runtime->execution().lifetime().hold(scene, node);
  client.nodes[++client.last_node] = {&scene, node};
  return client.last_node;
}

void Control::dispose(ControlClient& client, std::uint64_t number) {
  const auto node = client.nodes.extract(number);
  if (!node) return;
  client.known_nodes.erase(node_key(node.mapped().id));
  const auto document = client.world->document.lock();
  vrml::Execution& execution = document->runtime->execution();
  if (execution.scenes().has(node.mapped().scene)) execution.lifetime().release(*node.mapped().scene, node.mapped().id);
}

vrml::NodeId Control::find_name(ControlClient& client, std::string_view name) {
  const auto document = client.world->document.lock();
  if (!client.world->names) client.world->names = std::make_unique<vrml::NodeNames>(*document->world.scene);
  return client.world->names->find(name);
}

// Watched events ------------------------------------------------------------------------------------

std::uint64_t Control::watch(ControlClient& client, const PlacedNode& node, const vrml::InterfaceDeclaration& event) {
  const WatchedEvent watched{node.id, &event};
  const std::uint64_t number = ++client.last_watch;
  client.watches[number] = {node.scene, watched, {}, 0, 0};
  client.world->watched[watched].emplace_back(client.number, number);
  if (client.world->watched.size() == 1) observe(*client.world);
  return number;
}

bool Control::unwatch(ControlClient& client, std::uint64_t number) {
  const auto watch = client.watches.extract(number);
  if (!watch) return false;
  auto& watched = client.world->watched;
  const auto told = watched.find(watch.mapped().event);
  std::erase(told->second, std::pair(client.number, number));
  if (told->second.empty()) watched.erase(told);
  if (watched.empty()) observe(*client.world);
  return true;
}

// Starts or stops observing the events of a world. Without a watching client the observer would cost time, because it
// gets all events.
void Control::observe(ControlledWorld& world) {
  const auto document = world.document.lock();
  if (!document || !document->runtime) return;
  if (world.watched.empty()) {
    document->runtime->execution().cascade().observe({}, this);
  } else {
    document->runtime->execution().cascade().observe(
        [this, &world](const vrml::SentEvent& event) { note(world, event); }, this);
  }
}

void Control::note(ControlledWorld& world, const vrml::SentEvent& event) {
  const auto found = world.watched.find({event.node, event.event});
  if (found == world.watched.end()) return;
  for (const auto& [number, place] : found->second) {
    ControlClient& client = clients_.at(number);
    Watch& watch = client.watches.at(place);
    if (!watch.latest && seen_.size() < kMaxSeen && !channel_.is_behind(number)) {
      seen_.push_back({number, place, event.time, *event.value});
      continue;
    }
    // The client reads slowly. Keep only the last event for it; ISO/IEC 14772-2 allows that.
    if (watch.latest) {
      ++watch.missed;
    } else {
      client.late.push_back(place);
    }
    watch.latest = *event.value;
    watch.time = event.time;
  }
}

void Control::append_event(std::string& out, ControlClient& client, std::uint64_t number, const Watch& watch,
                           double time, const vrml::FieldValue& value, std::uint64_t missed) {
  const std::shared_ptr<Document> document = client.world->document.lock();
  const vrml::Execution& execution = document->runtime->execution();
  out += "{\"jsonrpc\":\"2.0\",\"method\":\"event\",\"params\":{\"watch\":" + std::to_string(number) + ",\"time\":";
  append_json_number(out, time);
  out += ",\"value\":";
  append_json_value(out, value, [&](std::string& to, vrml::NodeId node) {
    const bool there = execution.scenes().has(watch.scene) && watch.scene->contains(node);
    to += there ? std::to_string(number_of(client, *watch.scene, node)) : "null";
  });
  if (missed > 0) out += ",\"missed\":" + std::to_string(missed);
  out += "}}";
}

void Control::tell_events() {
  for (const Seen& one : std::exchange(seen_, {})) {
    const auto client = clients_.find(one.client);
    if (client == clients_.end()) continue;
    const auto watch = client->second.watches.find(one.watch);
    if (watch == client->second.watches.end() || client->second.world->document.expired()) continue;
    std::string out;
    append_event(out, client->second, one.watch, watch->second, one.time, one.value, 0);
    channel_.send(one.client, std::move(out));
  }
}

// Sends the last values of watches to slow clients that have read all earlier messages.
void Control::tell_late() {
  for (auto& [number, client] : clients_) {
    if (client.late.empty() || channel_.is_behind(number)) continue;
    for (const std::uint64_t place : std::exchange(client.late, {})) {
      const auto watch = client.watches.find(place);
      if (watch == client.watches.end() || !watch->second.latest) continue;
      std::string out;
      const vrml::FieldValue value = *std::exchange(watch->second.latest, std::nullopt);
      append_event(out, client, place, watch->second, watch->second.time, value,
                   std::exchange(watch->second.missed, 0));
      channel_.send(number, std::move(out));
    }
  }
}

}  // namespace gs::app

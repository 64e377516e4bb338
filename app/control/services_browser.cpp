#include "app/control/control.h"
#include "app/control/services.h"
#include "app/script/run_time_nodes.h"
#include "app/session/running/world_runtime.h"

#include <algorithm>

// Services for the browser (ISO/IEC 14772-2 4.4), and for messages between clients.
namespace gs::app {
namespace {

constexpr ParameterRow kUrl{"url", "string or list of strings, tried in order"};
constexpr ParameterRow kReceiver{"node", "node"};

void put_member(std::string& out, std::string_view name, std::string_view text) {
  out += (out.size() > 1 ? ",\"" : "\"") + std::string(name) + "\":";
  append_json_string(out, text);
}

void put_figure(std::string& out, std::string_view name, double number) {
  out += (out.size() > 1 ? ",\"" : "\"") + std::string(name) + "\":";
  append_json_number(out, number);
}

bool get_browser(ServiceCall& call) {
  std::string out = "{";
  put_member(out, "name", "GhostSpace");
  put_member(out, "version", GHOSTSPACE_VERSION);
  if (call.document) {
    const BrowserState& browser = call.document->runtime->programs().browser();
    put_member(out, "url", browser.world_url);
    put_member(out, "title", call.document->world.title);
    put_figure(out, "time", call.document->runtime->execution().now());
    put_figure(out, "speed", browser.speed);
    put_figure(out, "frameRate", browser.frame_rate);
  }
  call.result = out + "}";
  return true;
}

bool get_browser_name(ServiceCall& call) {
  call.result = "\"GhostSpace\"";
  return true;
}
bool get_version(ServiceCall& call) {
  call.result = "\"" GHOSTSPACE_VERSION "\"";
  return true;
}
bool get_speed(ServiceCall& call) {
  call.result.clear();
  append_json_number(call.result, call.document->runtime->programs().browser().speed);
  return true;
}
bool get_frame_rate(ServiceCall& call) {
  call.result.clear();
  append_json_number(call.result, call.document->runtime->programs().browser().frame_rate);
  return true;
}
bool get_world_url(ServiceCall& call) {
  call.result.clear();
  append_json_string(call.result, call.document->runtime->programs().browser().world_url);
  return true;
}

// Creates a request to the session. It has the permissions of the world's file.
ScriptRequest request_of(const ServiceCall& call, ScriptRequest::Kind kind) {
  ScriptRequest request;
  request.kind = kind;
  request.scene = call.document->world.scene.get();
  request.origin = request.scene;
  request.from_client = true;
  return request;
}

bool set_description(ServiceCall& call) {
  ScriptRequest request = request_of(call, ScriptRequest::Kind::description);
  const auto text = call.text(0);
  if (!text) return false;
  request.text = *text;
  call.session.links().serve(*call.document, request);
  return true;
}

bool load_url(ServiceCall& call) {
  ScriptRequest request = request_of(call, ScriptRequest::Kind::load_url);
  const auto urls = call.texts(0);
  const auto parameters = call.has(1) ? call.texts(1) : std::vector<std::string>{};
  if (!urls || !parameters) return false;
  request.urls = *urls;
  request.parameters = *parameters;
  call.changes = true;
  const auto refused = call.session.links().serve(*call.document, request);
  call.problem = refused.value_or("");
  return !refused;
}

void put_nodes(ServiceCall& call, std::string& out, vrml::SceneGraph& scene, const vrml::MFNode& nodes) {
  out += "\"nodes\":";
  call.append(out, vrml::FieldValue(nodes), scene);
}

bool create_from_string(ServiceCall& call) {
  const auto text = call.text(0);
  if (!text) return false;
  vrml::SceneGraph& scene = *call.document->world.scene;
  Diagnostics diagnostics;
  const vrml::RunTimeNodes made =
      call.document->runtime->programs().create(scene, "control", *text, diagnostics, &scene);
  std::string messages = "[";
  for (const Diagnostic& one : diagnostics.entries()) {
    if (messages.size() > 1) messages += ',';
    append_json_string(messages, one.text());
  }
  if (made.outcome == vrml::ParseOutcome::refused) {
    call.problem = "not VRML97 text";
    for (const Diagnostic& one : diagnostics.entries()) {
      call.problem += ": " + one.text();
      break;
    }
    return false;
  }
  call.result = "{";
  put_nodes(call, call.result, scene, made.roots);
  call.result += ",\"messages\":" + messages + "]}";
  call.changes = true;  // a new TimeSensor starts in the next step
  return true;
}

bool create_from_url(ServiceCall& call) {
  ScriptRequest request = request_of(call, ScriptRequest::Kind::create_from_url);
  const auto urls = call.texts(0);
  const auto node = urls ? call.node(1) : std::nullopt;
  const auto event = node ? call.text(2) : std::nullopt;
  if (!event) return false;
  request.urls = *urls;
  request.scene = node->scene;
  request.node = node->id;
  request.event_in = event_for_nodes(*node->scene, node->id, *event);
  if (!request.event_in) {
    call.fail_at(2, "the node has no eventIn of type MFNode with this name");
    return false;
  }
  request.location = node->scene->node(node->id).location;
  call.document->runtime->requests().create_from_url(std::move(request));
  call.changes = true;
  return true;
}

bool replace_world(ServiceCall& call) {
  const auto nodes = call.nodes(0);
  if (!nodes) return false;
  vrml::Execution& execution = call.document->runtime->execution();
  execution.cascade().begin_update();
  vrml::SceneGraph& scene = nodes->first ? *nodes->first : *call.document->world.scene;
  if (!execution.lifetime().replace_world(scene, nodes->second)) {
    call.problem = "expected nodes of the world";
    return false;
  }
  execution.cascade().drain();
  call.changes = true;
  return true;
}

template <bool kAdd>
bool change_route(ServiceCall& call) {
  const auto from = call.node(0);
  const auto out = from ? call.text(1) : std::nullopt;
  const auto to = out ? call.node(2) : std::nullopt;
  const auto in = to ? call.text(3) : std::nullopt;
  if (!in) return false;
  if (from->scene != to->scene) {
    call.problem = "expected two nodes of one file";
    return false;
  }
  const auto found = route_between(*from->scene, from->id, *out, to->id, *in);
  if (const auto* const why = std::get_if<std::string>(&found)) {
    call.problem = *why;
    return false;
  }
  const vrml::Route& route = std::get<vrml::Route>(found);
  vrml::Execution& execution = call.document->runtime->execution();
  // Nothing happens if a ROUTE that is added already exists, or one that is removed does not (VRML97 4.10.2).
  const bool done = kAdd ? execution.routes().add(*from->scene, route) : execution.routes().remove(*from->scene, route);
  call.result = done ? "{\"changed\":true}" : "{\"changed\":false}";
  return true;
}

bool begin_update(ServiceCall& call) {
  call.client.updates = true;
  return true;
}

bool end_update(ServiceCall& call) {
  call.client.updates = false;
  call.client.update_bytes = 0;
  const bool any = !call.client.update.empty();
  return !any || call.deliver(std::exchange(call.client.update, {}));
}

bool advise_browser(ServiceCall& call) {
  call.client.wants_browser_events = true;
  call.result = call.document ? "{\"initialized\":true}" : "{\"initialized\":false}";
  return true;
}

bool unadvise_browser(ServiceCall& call) {
  call.client.wants_browser_events = false;
  return true;
}

bool await_world(ServiceCall& call) {
  constexpr std::size_t kMaxWaiting = 1000;
  if (call.document) return true;
  if (call.client.waits_for_world.size() >= kMaxWaiting) {
    call.problem = "too many calls are waiting for a world";
    return false;
  }
  if (!call.id.empty()) call.client.waits_for_world.emplace_back(call.id);
  call.answers_later = true;
  return true;
}

bool get_services(ServiceCall& call) {
  std::string& out = call.result = "[";
  for (const ServiceRow* const row : all_services()) {
    if (out.size() > 1) out += ',';
    std::string one = "{";
    put_member(one, "name", row->name);
    one += ",\"parameters\":[";
    for (std::size_t i = 0; i < parameter_count(*row); ++i) {
      std::string parameter = "{";
      put_member(parameter, "name", row->parameters[i].name);
      put_member(parameter, "type", row->parameters[i].type);
      if (row->parameters[i].may_lack) parameter += ",\"mayLack\":true";
      one += (i ? "," : "") + parameter + "}";
    }
    one += "]";
    put_member(one, "result", row->result);
    put_member(one, "help", row->help);
    out += one + "}";
  }
  out += "]";
  return true;
}

bool quit(ServiceCall& call) {
  call.control.end();
  call.changes = true;
  return true;
}

constexpr ServiceRow kBrowserServices[] = {
    {"getBrowser",
     {},
     "{\"name\",\"version\",\"url\",\"title\",\"time\",\"speed\",\"frameRate\"}",
     "name and version of the program, and its world; members of the world are absent before the first world",
     false,
     get_browser},
    {"getName", {}, "string", "returns the name of the program", false, get_browser_name},
    {"getVersion", {}, "string", "returns the version of the program", false, get_version},
    {"getCurrentSpeed", {}, "number", "speed of the viewer in metres per second", true, get_speed},
    {"getCurrentFrameRate", {}, "number", "steps per second, from the last step", true, get_frame_rate},
    {"getWorldURL", {}, "string", "returns the URL of the world", true, get_world_url},
    {"setDescription", {{{"text", "string"}}}, "", "shows a text to the user", true, set_description},
    {"loadURL",
     {{kUrl, {"parameter", "string or list of strings, as in an Anchor (VRML97 6.2)", true}}},
     "",
     "opens another world, or binds a Viewpoint (`#NAME`), like an Anchor of this world; opens only files that the "
     "world may read, and no pages for a web browser",
     true,
     load_url},
    {"replaceWorld",
     {{{"nodes", "list of nodes"}}},
     "",
     "shows these nodes instead of the world; other nodes are deleted unless a client or Script uses them",
     true,
     replace_world},
    {"createVrmlFromString",
     {{{"text", "VRML97 text"}}},
     "{\"nodes\":[...],\"messages\":[...]}",
     "creates nodes that are in no field yet; messages report problems in the text",
     true,
     create_from_string},
    {"createVrmlFromURL",
     {{kUrl, kReceiver, {"event", "name of an eventIn of type MFNode"}}},
     "",
     "reads a file like an Inline of this world, then sends its nodes to the eventIn",
     true,
     create_from_url},
    {"addRoute",
     {{{"from", "node"}, {"eventOut", "string"}, {"to", "node"}, {"eventIn", "string"}}},
     "{\"changed\":true}",
     "adds a ROUTE; false means it exists already",
     true,
     change_route<true>},
    {"deleteRoute",
     {{{"from", "node"}, {"eventOut", "string"}, {"to", "node"}, {"eventIn", "string"}}},
     "{\"changed\":true}",
     "deletes a ROUTE; false means it does not exist",
     true,
     change_route<false>},
    {"beginUpdate",
     {},
     "",
     "holds later events of this client until `endUpdate`; they then share one timestamp",
     true,
     begin_update},
    {"endUpdate", {}, "", "sends the events held since `beginUpdate` as one cascade", true, end_update},
    {"adviseBrowser",
     {},
     "{\"initialized\":true}",
     "subscribes to the browser events `initialized` (a world was loaded) and `shutdown` (it ends); returns whether a "
     "world is open",
     false,
     advise_browser},
    {"unadviseBrowser", {}, "", "ends `adviseBrowser`", false, unadvise_browser},
    {"awaitWorld", {}, "", "answers as soon as a world is open", false, await_world},
    {"getServices",
     {},
     "[{\"name\",\"parameters\",\"result\",\"help\"},...]",
     "returns this table",
     false,
     get_services},
    {"quit", {}, "", "ends the program", false, quit},
};

}  // namespace

std::span<const ServiceRow> browser_services() { return kBrowserServices; }

}  // namespace gs::app

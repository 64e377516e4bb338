#include "app/control/control.h"
#include "app/control/services.h"
#include "app/session/running/world_runtime.h"
#include "app/view/navigation.h"
#include "net/control/digest.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>

// Services for views. They are our own, because ISO/IEC 14772-2 has none for views.
namespace gs::app {
namespace {

constexpr int kMaxSide = 4096;  // max width and height in pixels

void put_numbers(std::string& out, std::string_view name, std::span<const double> numbers) {
  out += (out.size() > 1 ? ",\"" : "\"") + std::string(name) + "\":[";
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i) out += ',';
    append_json_number(out, numbers[i]);
  }
  out += ']';
}

bool get_viewpoints(ServiceCall& call) {
  std::string& out = call.result = "[";
  const std::vector<render::ViewpointState>& viewpoints = call.view->list->viewpoints;
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    out += (i ? ",{\"viewpoint\":" : "{\"viewpoint\":") + std::to_string(i + 1) + ",\"description\":";
    append_json_string(out, viewpoints[i].description);
    out += ",\"name\":";
    append_json_string(out, viewpoints[i].name);
    out += call.view->viewpoint == i ? ",\"bound\":true}" : ",\"bound\":false}";
  }
  out += ']';
  return true;
}

bool set_viewpoint(ServiceCall& call) {
  JsonCursor json(*call.given[0]);
  ScriptRequest request;
  request.kind = ScriptRequest::Kind::viewpoint;
  std::string made;
  if (json.kind() == JsonKind::string) {
    request.text = std::string(json.string(made));
  } else {
    const auto number = call.whole(0, 1, call.view->list->viewpoints.size());
    if (!number) return false;
    request.text = std::to_string(*number);
  }
  if (!find_viewpoint(call.view->list->viewpoints, request.text)) {
    call.fail_at(
        0, "unknown Viewpoint '" + request.text.substr(0, 80) + "'; " + viewpoint_list(call.view->list->viewpoints));
    return false;
  }
  call.session.links().serve(*call.document, request);
  call.changes = true;
  return true;
}

bool get_viewer(ServiceCall& call) {
  const Pose& pose = call.view->navigation.pose;
  const glm::dquat q(pose.orientation);
  const glm::dvec3 v(q.x, q.y, q.z);
  const double size = glm::length(v);
  const double place[] = {pose.position.x, pose.position.y, pose.position.z};
  const double turn[] = {size > 0 ? v.x / size : 0, size > 0 ? v.y / size : 0, size > 0 ? v.z / size : 1,
                         2 * std::atan2(size, q.w)};
  call.result = "{";
  put_numbers(call.result, "position", place);
  put_numbers(call.result, "orientation", turn);
  call.result += ",\"fieldOfView\":";
  append_json_number(call.result, pose.field_of_view);
  if (pose.height > 0) {
    call.result += ",\"height\":";
    append_json_number(call.result, pose.height);
  }
  call.result += '}';
  return true;
}

bool set_viewer(ServiceCall& call) {
  Pose pose = call.view->navigation.pose;
  float place[3], turn[4];
  if (call.has(0)) {
    if (!call.numbers(0, place)) return false;
    pose.position = {place[0], place[1], place[2]};
  }
  if (call.has(1)) {
    if (!call.numbers(1, turn)) return false;
    const glm::vec3 axis(turn[0], turn[1], turn[2]);
    const float length = glm::length(axis);
    if (!(length > 0) || !std::isfinite(length)) {
      call.fail_at(1, "expected an axis and an angle in radians");
      return false;
    }
    pose.orientation = glm::angleAxis(turn[3], axis / length);
  }
  // The numbers of the client may be arbitrary, so normalise the pose.
  const double height = pose.height;
  pose = pose_of(world_from_viewer(pose), pose.field_of_view);
  pose.height = height;
  call.view->navigation.transition.reset();
  call.view->navigation.pose = pose;
  call.document->runtime->execution().viewer().jump();
  call.changes = true;
  return true;
}

bool snapshot(ServiceCall& call) {
  constexpr int kWidth = 1024, kHeight = 768;
  const auto width = call.has(0) ? call.whole(0, 1, kMaxSide) : kWidth;
  const auto height = call.has(1) ? call.whole(1, 1, kMaxSide) : kHeight;
  if (!width || !height) return false;
  if (!call.control.painter()) {
    call.problem = "this program cannot draw pictures";
    return false;
  }
  (void)follow_world(*call.view);
  const render::Camera camera = camera_of(call.view->navigation.pose);
  lay_out(*call.view, camera, glm::vec2(*width, *height));
  const auto made = call.control.painter()(*call.view, static_cast<int>(*width), static_cast<int>(*height));
  lay_out(*call.view, camera, call.view->size);
  if (const auto* why = std::get_if<std::string>(&made)) {
    call.problem = *why;
    return false;
  }
  call.result = "{\"width\":" + std::to_string(*width) + ",\"height\":" + std::to_string(*height) + ",\"png\":\"" +
                net::base64(std::get<std::vector<std::byte>>(made)) + "\"}";
  call.changes = true;
  return true;
}

bool get_viewports(ServiceCall& call) {
  const Panes& panes = call.session.panes();
  std::string& out = call.result = "[";
  std::size_t number = 0;
  for (const std::size_t pane : panes.visible()) {
    out += (number ? ",{\"viewport\":" : "{\"viewport\":") + std::to_string(number + 1) + ",\"file\":";
    append_json_string(out, panes.at(pane).view() ? panes.at(pane).shown : std::string());
    out += pane == panes.active() ? ",\"active\":true" : ",\"active\":false";
    out += number == call.client.viewport ? ",\"used\":true}" : ",\"used\":false}";
    ++number;
  }
  out += ']';
  return true;
}

bool use_viewport(ServiceCall& call) {
  const auto number = call.whole(0, 1, call.session.panes().visible().size());
  if (!number) return false;
  call.client.viewport = *number - 1;
  call.control.follow_viewport(call.session, call.client);
  return true;
}

constexpr ServiceRow kViewServices[] = {
    {"getViewpoints",
     {},
     "[{\"viewpoint\":1,\"description\",\"name\",\"bound\"},...]",
     "lists the Viewpoints of the world",
     true,
     get_viewpoints},
    {"setViewpoint",
     {{{"viewpoint", "description, DEF name or number"}}},
     "",
     "binds a Viewpoint and moves the viewer there",
     true,
     set_viewpoint},
    {"getViewer",
     {},
     "{\"position\":[x,y,z],\"orientation\":[x,y,z,angle],\"fieldOfView\"}",
     "returns the pose of the viewer in world coordinates: metres, axis and radians; in parallel projection also "
     "`height`, the extent of the smaller side of the picture",
     true,
     get_viewer},
    {"setViewer",
     {{{"position", "list of 3 numbers", true}, {"orientation", "list of 4 numbers: axis and radians", true}}},
     "",
     "moves the viewer there at once",
     true,
     set_viewer},
    {"snapshot",
     {{{"width", "number of pixels from 1 to 4096, default 1024", true},
       {"height", "number of pixels from 1 to 4096, default 768", true}}},
     "{\"width\",\"height\",\"png\":\"...\"}",
     "returns the view as a PNG file in base64",
     true,
     snapshot},
    {"getViewports",
     {},
     "[{\"viewport\":1,\"file\",\"active\",\"used\"},...]",
     "lists the visible viewports",
     false,
     get_viewports},
    {"useViewport",
     {{{"viewport", "number"}}},
     "",
     "directs later calls of this client to the world in this viewport (initially the first); node numbers and watches "
     "of the previous world become invalid",
     false,
     use_viewport},
};

}  // namespace

std::span<const ServiceRow> view_services() { return kViewServices; }

}  // namespace gs::app

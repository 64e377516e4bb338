#include "app/script/run_time_nodes.h"

namespace gs::app {

vrml::RunTimeNodes make_nodes(vrml::Execution& execution, vrml::SceneGraph& scene, const std::string& label,
                              std::string_view text, vrml::Diagnostics& diagnostics,
                              const vrml::SourceText* written_by) {
  vrml::RunTimeNodes made = vrml::read_into(scene, label, text, diagnostics, written_by);
  execution.attach(scene);
  return made;
}

bool send_made(vrml::Execution& execution, const ScriptRequest& request, const vrml::MFNode& nodes) {
  if (!execution.has_scene(request.scene) || !request.scene->contains(request.node)) return false;
  for (const vrml::NodeId id : nodes) execution.hold(*request.scene, id);
  const bool sent = execution.send(*request.scene, request.node, *request.event_in, vrml::FieldValue(nodes));
  for (const vrml::NodeId id : nodes) execution.release(*request.scene, id);
  return sent;
}

const vrml::InterfaceDeclaration* event_for_nodes(const vrml::SceneGraph& scene, vrml::NodeId node,
                                                  std::string_view event_in) {
  const vrml::InterfaceDeclaration* const found = scene.node(node).type->find_event_in(event_in);
  return found && found->type == vrml::FieldType::MFNode ? found : nullptr;
}

std::variant<vrml::Route, std::string> route_between(const vrml::SceneGraph& scene, vrml::NodeId from,
                                                     const std::string& event_out, vrml::NodeId to,
                                                     const std::string& event_in) {
  const vrml::Route route{from, to, scene.node(from).type->find_event_out(event_out),
                          scene.node(to).type->find_event_in(event_in)};
  if (!route.event_out) return "no eventOut '" + event_out.substr(0, 80) + "'";
  if (!route.event_in) return "no eventIn '" + event_in.substr(0, 80) + "'";
  if (route.event_out->type != route.event_in->type)
    return "'" + event_out + "' and '" + event_in + "' are of different types";
  return route;
}

}  // namespace gs::app

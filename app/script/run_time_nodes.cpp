#include "app/script/run_time_nodes.h"

#include "vrml/syntax/parser.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

std::optional<vrml::FieldValue> read_nodes(const std::string& text, vrml::FieldType type, vrml::NodeNames& names) {
  vrml::MFNode nodes;
  std::size_t open = 0, close = 0;
  constexpr std::string_view kBetween = " \t\r\n,";
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '[' || text[i] == ']' || kBetween.find(text[i]) != std::string_view::npos) {
      open += text[i] == '[' ? 1 : 0;
      close += text[i] == ']' ? 1 : 0;
      ++i;
      continue;
    }
    const std::size_t end = std::min(text.size(), text.find_first_of(" \t\r\n,[]", i));
    const std::string name = text.substr(i, end - i);
    const vrml::NodeId node = name == "NULL" ? vrml::NodeId{} : names.find(name);
    if (!node && name != "NULL") return std::nullopt;
    nodes.push_back(node);
    i = end;
  }
  if (type == vrml::FieldType::MFNode)
    return open <= 1 && open == close ? std::optional<vrml::FieldValue>(std::move(nodes)) : std::nullopt;
  return nodes.size() == 1 && open + close == 0 ? std::optional<vrml::FieldValue>(nodes[0]) : std::nullopt;
}

}  // namespace

std::optional<vrml::FieldValue> read_value(const std::string& text, vrml::FieldType type, vrml::NodeNames& names) {
  if (vrml::holds_nodes(type)) return read_nodes(text, type, names);
  vrml::NodeType holder;
  // Parse the text as the initial value of a PROTO field. Text after the value would add interfaces or fail.
  if (!vrml::parse_interface("field " + std::string(vrml::name_of(type)) + " value " + text, holder))
    return std::nullopt;
  if (holder.interfaces.size() != 1 || holder.interfaces[0].type != type) return std::nullopt;
  return std::move(holder.interfaces[0].initial);
}

vrml::RunTimeNodes make_nodes(vrml::Execution& execution, vrml::SceneGraph& scene, const std::string& label,
                              std::string_view text, Diagnostics& diagnostics, const vrml::SourceText* written_by,
                              std::shared_ptr<const vrml::TextSource> fetched_from) {
  vrml::RunTimeNodes made = vrml::read_into(scene, label, text, diagnostics, written_by, std::move(fetched_from));
  execution.scenes().attach(scene);
  return made;
}

bool send_made(vrml::Execution& execution, const ScriptRequest& request, const vrml::MFNode& nodes) {
  if (!execution.scenes().has(request.scene) || !request.scene->contains(request.node)) return false;
  for (const vrml::NodeId id : nodes) execution.lifetime().hold(*request.scene, id);
  const bool sent = execution.send(*request.scene, request.node, *request.event_in, vrml::FieldValue(nodes));
  for (const vrml::NodeId id : nodes) execution.lifetime().release(*request.scene, id);
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
    return "'" + event_out + "' and '" + event_in + "' have different types";
  return route;
}

}  // namespace gs::app

#pragma once

#include "app/script/script_runner.h"
#include "vrml/events/execution.h"
#include "vrml/scene/node_names.h"
#include "vrml/syntax/parser.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

// Changes that programs of Scripts and external clients make to a running world (VRML97 4.12.10, ISO/IEC 14772-2). On
// the thread of the world.
namespace gs::app {

/// Makes nodes of a text (createVrmlFromString). No field holds them yet: hold them before events go on. `label` names
/// the text in messages. `written_by` and `fetched_from`: see vrml::read_into.
[[nodiscard]] vrml::RunTimeNodes make_nodes(vrml::Execution& execution, vrml::SceneGraph& scene,
                                            const std::string& label, std::string_view text, Diagnostics& diagnostics,
                                            const vrml::SourceText* written_by,
                                            std::shared_ptr<const vrml::TextSource> fetched_from = nullptr);

/// Sends created nodes to the target of create_from_url. Returns false if the target no longer exists.
bool send_made(vrml::Execution& execution, const ScriptRequest& request, const vrml::MFNode& nodes);

/// Returns the eventIn for the nodes of create_from_url. Returns null if the node has no such eventIn of type MFNode.
[[nodiscard]] const vrml::InterfaceDeclaration* event_for_nodes(const vrml::SceneGraph& scene, vrml::NodeId node,
                                                                std::string_view event_in);

/// The ROUTE between two nodes of a scene, or why there can be none (4.10.2).
[[nodiscard]] std::variant<vrml::Route, std::string> route_between(const vrml::SceneGraph& scene, vrml::NodeId from,
                                                                   const std::string& event_out, vrml::NodeId to,
                                                                   const std::string& event_in);

/// Reads a value of a field type as the text of a file has it (VRML97 clause 5); nodes by what traces call them. Null
/// where the text is no such value.
[[nodiscard]] std::optional<vrml::FieldValue> read_value(const std::string& text, vrml::FieldType type,
                                                         vrml::NodeNames& names);

}  // namespace gs::app

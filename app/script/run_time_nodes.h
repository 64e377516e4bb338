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

// Changes to a running world by Scripts and by external clients (VRML97 4.12.10, ISO/IEC 14772-2). Call on the thread
// of the world.
namespace gs::app {

/// Makes nodes from VRML text, as createVrmlFromString does. No field refers to the nodes yet: the caller must hold
/// them before further events. `label` is the name of the text in messages. For `written_by` and `fetched_from`, see
/// vrml::read_into().
[[nodiscard]] vrml::RunTimeNodes make_nodes(vrml::Execution& execution, vrml::SceneGraph& scene,
                                            const std::string& label, std::string_view text, Diagnostics& diagnostics,
                                            const vrml::SourceText* written_by,
                                            std::shared_ptr<const vrml::TextSource> fetched_from = nullptr);

/// Sends nodes to the eventIn that a create_from_url request names. Returns false if the target node no longer exists.
bool send_made(vrml::Execution& execution, const ScriptRequest& request, const vrml::MFNode& nodes);

/// Returns the eventIn that receives the nodes of create_from_url. Returns null if the node has no MFNode eventIn of
/// this name.
[[nodiscard]] const vrml::InterfaceDeclaration* event_for_nodes(const vrml::SceneGraph& scene, vrml::NodeId node,
                                                                std::string_view event_in);

/// Returns the ROUTE between an eventOut and an eventIn, or the reason why it is impossible (4.10.2).
[[nodiscard]] std::variant<vrml::Route, std::string> route_between(const vrml::SceneGraph& scene, vrml::NodeId from,
                                                                   const std::string& event_out, vrml::NodeId to,
                                                                   const std::string& event_in);

/// Parses a value in the syntax of VRML97 files (clause 5). Nodes are written by their names in `names`, as in traces.
/// Returns nullopt if the text is no value of this type.
[[nodiscard]] std::optional<vrml::FieldValue> read_value(const std::string& text, vrml::FieldType type,
                                                         vrml::NodeNames& names);

}  // namespace gs::app

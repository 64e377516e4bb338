#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Receiver of diagnostics about EXTERNPROTOs.
using ReportAt = std::function<void(Severity, SourceLocation, std::string)>;

/// EXTERNPROTO that waits for its body.
struct AwaitedPrototype {
  vrml::NodeType* type = nullptr;  // used by the thread of its scene only
  std::string name;                // of the PROTO in the file; empty means the first one
  /// Name of a PROTO in the text that declares `type` (VRML97 4.9.2), used if no other file has it. Empty means the
  /// first one.
  std::optional<std::string> own_name;
};

/// Returns the PROTO of `library` that an EXTERNPROTO refers to, or null if it is missing. Reports a missing PROTO and
/// differences of the interfaces (VRML97 4.9.2).
[[nodiscard]] const vrml::NodeType* prototype_in_library(const vrml::SceneGraph& library, const vrml::NodeType& type,
                                                         const std::string& name, const ReportAt& report);
/// Returns the PROTO that an EXTERNPROTO refers to in its own text, which must be complete, or null if it is missing.
/// Reports a missing PROTO and differences of the interfaces.
[[nodiscard]] const vrml::NodeType* prototype_in_own_text(const vrml::SourceText& text, const vrml::NodeType& type,
                                                          const std::string& name, const ReportAt& report);
/// Reports that the body of an EXTERNPROTO is missing because of `why`. `replaced` is true if a stand-in is used.
/// Reports nothing for the fallbacks of our own nodes, which exist for other browsers.
void tell_missing_prototype(const vrml::NodeType& type, const std::string& why, bool replaced, const ReportAt& report);

/// Gives EXTERNPROTOs of a running scene, and their instances, the bodies from `library`. If `library` is null, `why`
/// is the reason, and stand-ins are used. Skips types that no longer exist. Returns false if no type got a body. Called
/// on the thread of the scene.
bool take_prototypes(vrml::SceneGraph& scene, const std::vector<AwaitedPrototype>& awaited,
                     std::unique_ptr<vrml::SceneGraph> library, const std::optional<std::string>& why,
                     Diagnostics& diagnostics);

}  // namespace gs::app

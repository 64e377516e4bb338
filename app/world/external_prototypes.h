#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// What is found out about EXTERNPROTOs goes here.
using ReportAt = std::function<void(vrml::Severity, vrml::SourceLocation, std::string)>;

/// An EXTERNPROTO that waits for its body.
struct AwaitedPrototype {
  vrml::NodeType* type = nullptr;  // touched by the thread of its scene only
  std::string name;                // of the PROTO in the file; empty: its first
  /// That of a PROTO of the text that `type` stands in (VRML97 4.9.2), if no other file has it; empty: its first.
  std::optional<std::string> own_name;
};

/// The PROTO of `library` that the EXTERNPROTO means; null: there is none. Both, and what does not agree (4.9.2), are
/// told.
[[nodiscard]] const vrml::NodeType* prototype_in_library(const vrml::SceneGraph& library, const vrml::NodeType& type,
                                                         const std::string& name, const ReportAt& report);
/// The same for one that names a PROTO of the text it stands in, all of which is there.
[[nodiscard]] const vrml::NodeType* prototype_in_own_text(const vrml::SourceText& text, const vrml::NodeType& type,
                                                          const std::string& name, const ReportAt& report);
/// The body cannot be had, because of `why`; a stand-in takes its place where `replaced`. Nothing is told of what is
/// a fallback for browsers that do not know a node of our own.
void tell_missing_prototype(const vrml::NodeType& type, const std::string& why, bool replaced, const ReportAt& report);

/// EXTERNPROTOs of a scene of a living world get their bodies, and instances theirs, as of `library`; null: it cannot
/// be had, because of `why`, and stand-ins take their places. Types that are gone meanwhile are passed over. False:
/// none got a body. The thread of the scene.
bool take_prototypes(vrml::SceneGraph& scene, const std::vector<AwaitedPrototype>& awaited,
                     std::unique_ptr<vrml::SceneGraph> library, const std::optional<std::string>& why,
                     vrml::Diagnostics& diagnostics);

}  // namespace gs::app

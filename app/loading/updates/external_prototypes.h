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
  vrml::NodeType* type = nullptr;  // used only by the thread of the type's scene
  /// File and PROTO name of each URL, in order. An empty name means the first PROTO of the file.
  struct Reference {
    std::string file, name;
  };
  std::vector<Reference> references;
  std::size_t loaded = 0;  // index of the reference to the loaded file
  /// Name of a PROTO in the same file as `type` (VRML97 4.9.2). Used if no other file has the PROTO. Empty means the
  /// first PROTO.
  std::optional<std::string> own_name;
};

/// Returns the PROTO of the loaded library that the EXTERNPROTO refers to, with the name of the URL that was loaded
/// (VRML97 4.9.3), or of a later URL of the same file. Returns null if the library has none.
[[nodiscard]] const vrml::NodeType* find_awaited(const vrml::SceneGraph& library, const AwaitedPrototype& awaited);
/// Like find_awaited(), but also reports a missing PROTO, and differences between the two interfaces (VRML97 4.9.2).
[[nodiscard]] const vrml::NodeType* prototype_in_library(const vrml::SceneGraph& library,
                                                         const AwaitedPrototype& awaited, const ReportAt& report);
/// Returns the PROTO of `text` that the EXTERNPROTO `type` in the same text refers to. `text` must be complete. If the
/// PROTO is missing, reports that and returns null. Also reports differences between the two interfaces.
[[nodiscard]] const vrml::NodeType* prototype_in_own_text(const vrml::SourceText& text, const vrml::NodeType& type,
                                                          const std::string& name, const ReportAt& report);
/// Reports that the body of an EXTERNPROTO is missing, with the reason `why`. `replaced` is true if a stand-in is used.
/// Reports nothing for PROTOs with the name of a built-in QNV node, which exist for other browsers.
void tell_missing_prototype(const vrml::NodeType& type, const std::string& why, bool replaced, const ReportAt& report);

/// Gives the EXTERNPROTOs `awaited` of a running scene, and their instances, the bodies from `library`. If `library` is
/// null, uses stand-ins and reports `why`. Skips types that no longer exist. Returns false if no type got a body. Must
/// run on the thread of the scene.
bool take_prototypes(vrml::SceneGraph& scene, const std::vector<AwaitedPrototype>& awaited,
                     std::unique_ptr<vrml::SceneGraph> library, const std::optional<std::string>& why,
                     Diagnostics& diagnostics);

}  // namespace gs::app

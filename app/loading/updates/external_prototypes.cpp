#include "app/loading/updates/external_prototypes.h"

#include "app/loading/updates/missing_url.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/stand_ins.h"

#include <memory>
#include <utility>

namespace gs::app {
namespace {

using vrml::NodeType;

void tell_unlike(const NodeType& type, const NodeType& source, const std::string& file, const ReportAt& report) {
  if (const vrml::InterfaceDeclaration* odd = vrml::unlike_prototype(type, source))
    report(Severity::warning, type.location,
           "PROTO " + source.name + " of " + file + " has no " + std::string(name_of(odd->access)) + ' ' +
               std::string(name_of(odd->type)) + " '" + odd->name + "', as declared by EXTERNPROTO " + type.name +
               " (VRML97 4.9.2)");
}

}  // namespace

const NodeType* find_awaited(const vrml::SceneGraph& library, const AwaitedPrototype& awaited) {
  const std::vector<AwaitedPrototype::Reference>& references = awaited.references;
  for (std::size_t i = awaited.loaded; i < references.size(); ++i)
    if (references[i].file == references[awaited.loaded].file)
      if (const NodeType* found = vrml::find_prototype(library, references[i].name)) return found;
  return nullptr;
}

const NodeType* prototype_in_library(const vrml::SceneGraph& library, const AwaitedPrototype& awaited,
                                     const ReportAt& report) {
  const NodeType& type = *awaited.type;
  const NodeType* source = find_awaited(library, awaited);
  if (!source || !source->prototype) {
    const std::string name =
        awaited.loaded < awaited.references.size() ? awaited.references[awaited.loaded].name : std::string();
    report(Severity::error, {},
           library.file_name() + " declares no PROTO" + (name.empty() ? "" : " '" + name + "'") + " for EXTERNPROTO " +
               type.name);
    return nullptr;
  }
  tell_unlike(type, *source, library.file_name(), report);
  return source;
}

const NodeType* prototype_in_own_text(const vrml::SourceText& text, const NodeType& type, const std::string& name,
                                      const ReportAt& report) {
  const NodeType* source = vrml::find_own_prototype(text, name);
  if (!source) {
    report(Severity::error, type.location,
           "no PROTO" + (name.empty() ? "" : " '" + name + "'") + " in this file for EXTERNPROTO " + type.name);
    return nullptr;
  }
  tell_unlike(type, *source, text.file_name(), report);
  return source;
}

void tell_missing_prototype(const NodeType& type, const std::string& why, bool replaced, const ReportAt& report) {
  const NodeType* own = vrml::built_in_node_type(type.name);
  if (own && own->url_content == vrml::UrlContent::vectors) return;
  if (replaced && vrml::built_in_node_of_urn(type.url)) return;  // the URN requests exactly this built-in node
  report(Severity::warning, type.location,
         "EXTERNPROTO " + type.name + ": " + why_missing(type.url, why) + (replaced ? "; a stand-in replaces it" : ""));
}

bool take_prototypes(vrml::SceneGraph& scene, const std::vector<AwaitedPrototype>& awaited,
                     std::unique_ptr<vrml::SceneGraph> library, const std::optional<std::string>& why,
                     Diagnostics& diagnostics) {
  vrml::SceneGraph* attached = nullptr;
  bool any = false;
  for (const AwaitedPrototype& one : awaited) {
    const std::optional<std::uint32_t> owner = scene.texts().declaring(one.type);
    if (!owner || one.type->prototype) continue;
    const vrml::WritingFor writing(scene, *owner);
    vrml::SourceText& text = scene.texts().writing();
    const ReportAt report = [&](Severity severity, SourceLocation at, std::string message) {
      diagnostics.add({severity, text.file_name(), at, std::move(message)});
    };
    const NodeType* source = nullptr;
    if (library || attached) {
      if (!attached) attached = &text.attach_library(std::move(library));
      source = prototype_in_library(*attached, one, report);
    } else if (one.own_name) {
      source = prototype_in_own_text(text.origin(), *one.type, *one.own_name, report);
      if (source && vrml::stands_inside(*one.type, *source)) {
        report(Severity::error, one.type->location,
               "EXTERNPROTO " + one.type->name + " is inside its own PROTO " + source->name + "; left out");
        continue;
      }
    }
    if (!source) {
      source = vrml::stand_in_for(scene, *one.type);
      if (why && !one.own_name) tell_missing_prototype(*one.type, *why, source != nullptr, report);
    }
    if (!source) continue;
    any = true;
    if (!vrml::resolve_external(scene, *one.type, *source))
      report(Severity::error, {}, "EXTERNPROTO instances exceed the limit of nodes; the rest stay empty");
  }
  return any;
}

}  // namespace gs::app

#include "app/base/text_source.h"
#include "app/script/bounds/bounded_natives.h"
#include "app/script/natives.h"
#include "app/script/script_library.h"
#include "vrml/syntax/printer.h"

#include <js/Object.h>
#include <jsfriendapi.h>

#include <utility>

// Libraries of Scripts, and the rule for which nodes a Script may read (docs/security.md).
namespace gs::app::script {

ScriptLibrary::ScriptLibrary(World& of, vrml::Execution& execution, JSContext* context) : world(&of), global(context) {
  link->execution = &execution;
  for (int i = 0; i <= kRowPrototype; ++i) prototypes.emplace_back(context);
}

const vrml::SourceText& text_of_program(const Program& program) {
  const vrml::Node& node = program.scene->node(program.id);
  const vrml::InterfaceDeclaration* const url = node.type->find_field("url");
  return url ? program.scene->nodes().text_of(program.id, url->slot) : *node.text;
}

ScriptLibraries::~ScriptLibraries() {
  for (const auto& [key, library] : libraries_) {
    library->link->execution = nullptr;
    if (!library->global) continue;
    const JSAutoRealm realm(engine_.context(), library->global);
    JS_SetCompartmentPrivate(js::GetContextCompartment(engine_.context()), nullptr);
  }
}

ScriptLibrary* ScriptLibraries::of(const std::shared_ptr<const vrml::TextSource>& source, vrml::Language language) {
  // No key of a source begins with a blank.
  const std::string prefix = language == vrml::Language::x3d ? " x3d " : "";
  std::string key = prefix + library_key(origin_of(source));
  auto found = libraries_.find(key);
  if (found == libraries_.end()) {
    auto made = std::make_unique<ScriptLibrary>(world_, execution_, engine_.context());
    found = libraries_.emplace(std::move(key), std::move(made)).first;
  }
  ScriptLibrary& library = *found->second;
  library.language = language;
  return library.global || make(library) ? &library : nullptr;
}

bool ScriptLibraries::make(ScriptLibrary& library) {
  JSContext* const context = engine_.context();
  JS::RootedObject global(context, new_global(context, nullptr, nullptr));
  if (!global) return false;
  const JSAutoRealm realm(context, global);
  JS_SetCompartmentPrivate(js::GetContextCompartment(context), &library);
  auto& prototypes = library.prototypes;
  const bool good = bound_natives(context, global) && define_tuples(context, global, prototypes) &&
                    define_images(context, global, prototypes) && define_lists(context, global, prototypes) &&
                    define_nodes(context, global, prototypes) && define_matrices(context, global, prototypes) &&
                    define_browser(context, global) &&
                    (library.language != vrml::Language::x3d || define_x3d(context, global));
  if (!good) {
    JS_ClearPendingException(context);
    JS_SetCompartmentPrivate(js::GetContextCompartment(context), nullptr);
    return false;
  }
  library.global = global;
  // Freeze the prototypes, because several programs share them and none may change them for the others.
  for (const JS::PersistentRootedObject& prototype : prototypes) {
    JS::RootedObject object(context, prototype);
    if (object) (void)JS_FreezeObject(context, object);
  }
  return true;
}

bool ReadGuard::may_read(Program& program, const vrml::Node& node) {
  const std::shared_ptr<const vrml::TextSource>& source = node.text->source();
  if (source == program.source) return true;
  auto& known = program.readings[source.get()];
  if (!known.first)
    known = {source, reading(origin_of(program.source), origin_of(program.scene->source()), origin_of(source))};
  if (known.second == Reading::refused) {
    messages_.report(
        Severity::warning, program,
        "cannot read nodes of " + origin_of(source).site() + ": a Script reads nodes of its own host only");
    return false;
  }
  if (known.second == Reading::confidential && private_file_.empty()) private_file_ = origin_of(source).url;
  return true;
}

}  // namespace gs::app::script

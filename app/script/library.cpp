#include "app/script/bounds/bounded_natives.h"
#include "app/script/natives.h"
#include "app/script/script_library.h"

#include <js/Object.h>
#include <jsfriendapi.h>

#include <utility>

// Libraries of Scripts.
namespace gs::app::script {

ScriptLibrary::ScriptLibrary(World& of, WorldView& view, JSContext* context) : world(&of), global(context) {
  link->view = &view;
  for (int i = 0; i <= kRowPrototype; ++i) prototypes.emplace_back(context);
}

ScriptLibraries::~ScriptLibraries() {
  for (const auto& [key, library] : libraries_) {
    library->link->view = nullptr;
    if (!library->global) continue;
    const JSAutoRealm realm(engine_.context(), library->global);
    JS_SetCompartmentPrivate(js::GetContextCompartment(engine_.context()), nullptr);
  }
}

ScriptLibrary* ScriptLibraries::of(const ProgramFacts& facts) {
  // No key of a source begins with a blank.
  const std::string prefix = facts.language == vrml::Language::x3d ? " x3d " : "";
  std::string key = prefix + facts.library;
  auto found = libraries_.find(key);
  if (found == libraries_.end()) {
    auto made = std::make_unique<ScriptLibrary>(world_, view_, engine_.context());
    found = libraries_.emplace(std::move(key), std::move(made)).first;
  }
  ScriptLibrary& library = *found->second;
  library.language = facts.language;
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

}  // namespace gs::app::script

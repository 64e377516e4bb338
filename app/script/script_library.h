#pragma once

#include "app/script/program.h"
#include "base/noncopyable.h"

#include <memory>
#include <string>
#include <unordered_map>

namespace gs::app::script {

/// Libraries of a world, one for each site and local file, and for each language. They outlive the world, because
/// objects may be collected later; the destructor detaches them. One thread.
class ScriptLibraries : NonCopyable {
 public:
  /// All arguments must outlive the object.
  ScriptLibraries(World& world, WorldView& view, Engine& engine) : world_(world), view_(view), engine_(engine) {}
  ~ScriptLibraries();

  /// Returns the library of a program. Creates it if necessary. Returns null if memory is insufficient.
  ScriptLibrary* of(const ProgramFacts& facts);

 private:
  bool make(ScriptLibrary& library);

  World& world_;
  WorldView& view_;
  Engine& engine_;
  std::unordered_map<std::string, std::unique_ptr<ScriptLibrary>> libraries_;  // by key and language
};

}  // namespace gs::app::script

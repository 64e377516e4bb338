#pragma once

#include "app/script/program.h"
#include "app/script/script_messages.h"
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
  ScriptLibraries(World& world, vrml::Execution& execution, Engine& engine)
      : world_(world), execution_(execution), engine_(engine) {}
  ~ScriptLibraries();

  /// Returns the library for Scripts of this source and language. Creates it if necessary. Returns null if memory is
  /// insufficient.
  ScriptLibrary* of(const std::shared_ptr<const vrml::TextSource>& source, vrml::Language language);

 private:
  bool make(ScriptLibrary& library);

  World& world_;
  vrml::Execution& execution_;
  Engine& engine_;
  std::unordered_map<std::string, std::unique_ptr<ScriptLibrary>> libraries_;  // by library_key() and language
};

/// Guard of the nodes that programs may read (docs/security.md). One thread.
class ReadGuard {
 public:
  explicit ReadGuard(ScriptMessages& messages) : messages_(messages) {}

  /// Reports whether a program may read this node. Records the first confidential read; warns once about refused reads.
  bool may_read(Program& program, const vrml::Node& node);
  /// Returns the URL of the first confidential file that a program has read; empty if there is none.
  [[nodiscard]] const std::string& private_file() const { return private_file_; }

 private:
  ScriptMessages& messages_;
  std::string private_file_;
};

}  // namespace gs::app::script

#pragma once

#include "app/script/world/script_messages.h"
#include "base/noncopyable.h"

#include <string>

namespace gs::app::script {

/// Guard of the nodes that programs may read (docs/security.md). One thread.
class ReadGuard : NonCopyable {
 public:
  explicit ReadGuard(ScriptMessages& messages) : messages_(messages) {}

  /// Reports whether a program may read this node. Records the first confidential read; warns once about refused reads.
  bool may_read(ScriptRecord& script, const vrml::Node& node);
  /// Returns the URL of the first confidential file that a program has read; empty if there is none.
  [[nodiscard]] const std::string& private_file() const { return private_file_; }

 private:
  ScriptMessages& messages_;
  std::string private_file_;
};

}  // namespace gs::app::script

#include "app/script/world/read_guard.h"

#include "app/base/text_source.h"

namespace gs::app::script {

bool ReadGuard::may_read(ScriptRecord& script, const vrml::Node& node) {
  const std::shared_ptr<const vrml::TextSource>& source = node.text->source();
  if (source == script.source) return true;
  auto& known = script.readings[source.get()];
  if (!known.first)
    known = {source, reading(origin_of(script.source), origin_of(script.scene->source()), origin_of(source))};
  if (known.second == Reading::refused) {
    messages_.report(
        Severity::warning, script,
        "cannot read nodes of " + origin_of(source).site() + ": a Script reads nodes of its own host only");
    return false;
  }
  if (known.second == Reading::confidential && private_file_.empty()) private_file_ = origin_of(source).url;
  return true;
}

}  // namespace gs::app::script

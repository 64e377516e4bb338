#pragma once

#include "app/interface/model/ui_splats.h"
#include "app/session/session.h"
#include "app/view/viewports.h"
#include "base/noncopyable.h"

#include <functional>
#include <optional>
#include <utility>

namespace gs::app {

/// Extension of the session that shows edited splats in the visible viewports. Main thread.
class SplatEditing final : public SessionExtension, NonCopyable {
 public:
  /// Another thread calls `wake` when edited splats are ready.
  explicit SplatEditing(std::function<void()> wake) : wake_(std::move(wake)) {}
  bool act(Session& session) override;

 private:
  std::function<void()> wake_;
};

/// Returns the splats of the active viewport for the interface. `place` is the rectangle of its picture; nullopt leaves
/// out the outlines of the crops.
[[nodiscard]] UiSplats describe_splats(Session& session, const std::optional<Viewport>& place);
/// Carries out the user's requests for splats.
void apply_splats(const UiSplatActions& actions, Session& session);

}  // namespace gs::app

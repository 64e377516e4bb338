#pragma once

#include "app/interface/panels/panel.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Panel with the log messages of the session's files. The filters only hide messages.
class LogPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  void rows_of(const PanelFrame& frame, const std::vector<CountedDiagnostic>& rows);
  std::string searched_, newest_;  // search text; path of the last file that has messages
  std::optional<std::size_t> goes_to_;  // index of the row to scroll to
  bool show_errors_ = true, show_warnings_ = true, show_notes_ = true;
};

}  // namespace gs::app

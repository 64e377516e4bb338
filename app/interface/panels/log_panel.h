#pragma once

#include "app/interface/panels/panel.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// What was said of the files of the session. It shows less when the user says so, and drops nothing.
class LogPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  void rows_of(const PanelFrame& frame, const std::vector<const vrml::Diagnostic*>& rows);
  std::string searched_, newest_;       // `newest_`: of the files with rows
  std::optional<std::size_t> goes_to_;  // the row that is first in sight next
  bool show_errors_ = true, show_warnings_ = true, show_notes_ = true;
};

}  // namespace gs::app

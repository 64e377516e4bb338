#pragma once

#include "app/interface/dock/dock.h"
#include "app/interface/panels/panel.h"
#include "app/view/actions.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace gs::app {

/// Row of the table of panels, which defines dock, menus, command palette and saved settings. A new panel needs a class
/// in this folder, a row in this table, and a row in the action table.
struct PanelRow {
  std::string_view id;  // key in the saved settings; must never change
  std::string_view title;  // tab title
  DockSide side;           // initial side
  Action toggle;           // action that opens and closes it
  std::unique_ptr<Panel> (*make)();
};
[[nodiscard]] std::span<const PanelRow> panel_rows();
/// Returns the index of the panel that an action opens and closes; nullopt if it is no such action.
[[nodiscard]] std::optional<std::size_t> panel_of(Action action);
[[nodiscard]] std::optional<std::size_t> find_panel(std::string_view id);

}  // namespace gs::app

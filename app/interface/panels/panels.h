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

/// Row of the table of panels. Dock, menus, command palette and saved settings are built from it. A new panel needs a
/// class in this folder, a row here, and a row in the action table.
struct PanelRow {
  std::string_view id;     // settings key; must never change
  std::string_view title;  // tab title
  DockSide side;           // initial side
  Action toggle;           // action that opens and closes it
  std::unique_ptr<Panel> (*make)();
};
[[nodiscard]] std::span<const PanelRow> panel_rows();
/// Returns the number of the panel that an action toggles; nullopt if it toggles none.
[[nodiscard]] std::optional<std::size_t> panel_of(Action action);
[[nodiscard]] std::optional<std::size_t> find_panel(std::string_view id);

}  // namespace gs::app

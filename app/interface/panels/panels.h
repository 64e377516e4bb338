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

/// A row of the table of panels: the dock, the menus, the palette of commands and what is kept of the user's choices
/// are made of it. A new panel is a class in this folder, a row here, and a row in the table of actions.
struct PanelRow {
  std::string_view id;     // in settings: it never changes
  std::string_view title;  // on its tab
  DockSide side;           // where it stands at first
  Action toggle;           // opens and closes it
  std::unique_ptr<Panel> (*make)();
};
[[nodiscard]] std::span<const PanelRow> panel_rows();
/// The number of the panel that an action opens and closes; nothing: it is no panel's.
[[nodiscard]] std::optional<std::size_t> panel_of(Action action);
[[nodiscard]] std::optional<std::size_t> find_panel(std::string_view id);

}  // namespace gs::app

#include "app/interface/panels/panels.h"

#include "app/interface/panels/data_panel.h"
#include "app/interface/panels/inspect_panels.h"
#include "app/interface/panels/log_panel.h"
#include "app/interface/panels/measure_panel.h"
#include "app/interface/panels/splats_panel.h"
#include "app/interface/panels/transfer_panel.h"

#include <algorithm>

namespace gs::app {
namespace {

constexpr PanelRow kPanels[] = {
    {"transfer-function", "Transfer function", DockSide::right, Action::transfer, make_panel<TransferPanel>},
    {"scene-tree", "Scene tree", DockSide::left, Action::scene_tree, make_panel<ScenePanel>},
    {"data", "Data", DockSide::right, Action::data, make_panel<DataPanel>},
    {"splats", "Splats", DockSide::right, Action::splats, make_panel<SplatsPanel>},
    {"inspector", "Inspector", DockSide::right, Action::inspector, make_panel<InspectorPanel>},
    {"routes", "Routes", DockSide::bottom, Action::routes, make_panel<RoutesPanel>},
    {"script-console", "Script console", DockSide::bottom, Action::script_console, make_panel<ConsolePanel>},
    {"streams", "Streams", DockSide::bottom, Action::streams, make_panel<StreamsPanel>},
    {"measure", "Measure", DockSide::right, Action::measure, make_panel<MeasurePanel>},
    {"pictures", "Pictures", DockSide::right, Action::pictures, make_panel<PicturePanel>},
    {"log", "Log", DockSide::bottom, Action::log, make_panel<LogPanel>},
};

template <class Wanted>
std::optional<std::size_t> find_row(Wanted wanted) {
  const auto row = std::find_if(std::begin(kPanels), std::end(kPanels), wanted);
  if (row == std::end(kPanels)) return std::nullopt;
  return static_cast<std::size_t>(row - std::begin(kPanels));
}

}  // namespace

std::span<const PanelRow> panel_rows() { return kPanels; }

std::optional<std::size_t> panel_of(Action action) {
  return find_row([action](const PanelRow& row) { return row.toggle == action; });
}

std::optional<std::size_t> find_panel(std::string_view id) {
  return find_row([id](const PanelRow& row) { return row.id == id; });
}

}  // namespace gs::app

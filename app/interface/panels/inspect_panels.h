#pragma once

#include "app/inspect/inspection.h"
#include "app/interface/panels/panel.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

// Panels that inspect the world of the active viewport. They only draw; app/inspect holds the data.
namespace gs::app {

/// Returns the inspection of an open world, and marks a part of it as drawn. Otherwise returns null, and prints a note.
[[nodiscard]] Inspection* drawn_inspection(const UiModel& model, bool InspectionWants::*part);

/// Node tree of the world, with a search field.
class ScenePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  void search_row(const PanelFrame& frame, Inspection& inspection, UiActions& actions);
  static void metadata(const Inspection& inspection);
  void rows(const PanelFrame& frame, Inspection& inspection);
  bool line(const PanelFrame& frame, Inspection& inspection, std::size_t index);
  void keys(Inspection& inspection);

  std::string sought_;
  std::optional<std::size_t> line_;  // line of the selected node; nullopt if the node was selected elsewhere
};

/// Fields and events of the selected node; some are editable.
class InspectorPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;
  /// Clears the message about a rejected value.
  bool close_one() override;

 private:
  struct Field;
  void head(const PanelFrame& frame, Inspection& inspection);
  void row(const PanelFrame& frame, Inspection& inspection, const vrml::InterfaceDeclaration& interface,
           UiActions& actions);
  void value(const Field& field, UiActions& actions);
  void list(const Field& field, UiActions& actions);
  void element(const Field& field, std::size_t index, UiActions& actions);
  bool edited_text(const char* id, const vrml::FieldValue& value, std::string& entered);
  void note(const Field& field, const std::optional<std::string>& problem);

  NodeAt node_;  // node that was displayed last
  /// List value that the user expanded, with the index of its first visible element.
  struct OpenList {
    const vrml::InterfaceDeclaration* of;
    std::size_t first = 0;
  };
  std::vector<OpenList> open_;
  const vrml::InterfaceDeclaration* problem_of_ = nullptr;
  std::string problem_;    // error message of the last rejected value
  unsigned typed_in_ = 0;  // Dear ImGui ID of the focused field with text that was not sent; 0 if there is none
  std::string typed_;
};

/// ROUTEs of the world with their activity.
class RoutesPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;
};

/// Output of the world's Scripts, and an input line for script code.
class ConsolePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  std::string line_;
  std::size_t shown_ = 0;  // number of lines at the last drawing
};

/// Progress and rates of the files and streams that worlds load.
class StreamsPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  std::uint64_t chosen_ = 0;  // LoadRow::number of the row with the large graph
  const LoadLedger* chosen_of_ = nullptr;
};

/// Draws the outline of the selected node over the picture.
void draw_marks(const Inspection& inspection);

}  // namespace gs::app

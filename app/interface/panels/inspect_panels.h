#pragma once

#include "app/inspect/inspection.h"
#include "app/interface/panels/panel.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

// Panels that look into the world of the active viewport: thin faces of app/inspect, which has all that they show.
namespace gs::app {

/// The nodes of the world, as a tree; a search in it.
class ScenePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  void search_row(const PanelFrame& frame, Inspection& inspection, UiActions& actions);
  void rows(const PanelFrame& frame, Inspection& inspection);
  bool line(const PanelFrame& frame, Inspection& inspection, std::size_t index);
  void keys(Inspection& inspection);

  std::string sought_;
  std::optional<std::size_t> line_;  // of the chosen node, where it was chosen
};

/// The fields and events of the chosen node, some of which can be changed.
class InspectorPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

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

  NodeAt node_;  // that it showed last
  /// Of a list that is open: the element that stands first.
  struct OpenList {
    const vrml::InterfaceDeclaration* of;
    std::size_t first = 0;
  };
  std::vector<OpenList> open_;
  const vrml::InterfaceDeclaration* problem_of_ = nullptr;
  std::string problem_;  // why its last value was not sent
  unsigned typed_in_ = 0;  // the field that has the keys, and what is typed there; 0: none
  std::string typed_;
};

/// The ROUTEs of the world, and which of them events go by.
class RoutesPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;
};

/// What the programs of the world say, and a line that is run as a part of one of them.
class ConsolePanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  std::string line_;
  std::size_t shown_ = 0;  // lines, when it was drawn last
};

/// The files and streams that worlds read: how far, how fast.
class StreamsPanel final : public Panel {
 public:
  void draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) override;

 private:
  std::uint64_t chosen_ = 0;  // LoadRow::number of the one whose rate is drawn large
  const LoadLedger* chosen_of_ = nullptr;
};

/// Lines around what is chosen, over the picture.
void draw_marks(const Inspection& inspection);

}  // namespace gs::app

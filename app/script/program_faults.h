#pragma once

#include "app/script/program.h"

#include <optional>
#include <string>

namespace gs::app::script {

/// Reporter of the failures of programs. Switches a program off after its third fault. One thread.
class ProgramFaults {
 public:
  /// Both arguments must outlive the object.
  ProgramFaults(Engine& engine, WorldView& view) : engine_(engine), view_(view) {}

  /// Reports that a turn of a program failed, and clears the pending exception. `heap` is the limit of the turn.
  void report(Program& program, const Engine::Turn& turn, std::size_t heap);

 private:
  void report_exception(Program& program);
  void add(Program& program, const std::string& why, std::optional<Diagnostic> at = {});

  Engine& engine_;
  WorldView& view_;
};

}  // namespace gs::app::script

#pragma once

#include "app/script/boundary/program_host.h"
#include "app/script/boundary/world_view.h"
#include "app/script/program_calls.h"
#include "app/script/script_library.h"

#include <cstdint>
#include <memory>
#include <unordered_map>

namespace gs::app::script {

/// Implementation of ProgramHost: the programs of one world in this process, and the parts that serve them.
class World final : public ProgramHost {
 public:
  World(WorldAccess& world, Engine& engine, bool repeatable);
  ~World() override;

  [[nodiscard]] Report run(const Order& order) override;

  // Parts for calls from programs.
  [[nodiscard]] Engine& engine() { return engine_; }
  [[nodiscard]] WorldView& view() { return view_; }
  [[nodiscard]] ProgramCalls& calls() { return calls_; }

 private:
  [[nodiscard]] Program* program_of(vrml::EventNode node) const;
  [[nodiscard]] Report obey(const Order& order);
  [[nodiscard]] Report start(const Order& order);
  [[nodiscard]] Report check(const Order& order);
  Program& program_for(const Order& order);
  /// Compiles and runs the text of an order. Returns false if the text cannot be compiled.
  bool start_text(Program& program, const Order& order);
  bool load(Program& program, const Order& order);
  void forget(vrml::EventNode node);

  Engine& engine_;
  WorldView view_;
  ProgramCalls calls_;
  ScriptLibraries libraries_;
  std::unordered_map<vrml::EventNode, std::unique_ptr<Program>> programs_;
  std::uint64_t last_serial_ = 0;
  JS::PersistentRootedObject checked_;  // global object of programs that are only compiled
};

}  // namespace gs::app::script

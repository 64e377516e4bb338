#pragma once

#include <string>

/// For lists of functions as macros take them: a member for each, and how each is found in a `library`.
#define GHOSTSPACE_LIBRARY_MEMBER(name) decltype(&::name) name = nullptr;
#define GHOSTSPACE_LIBRARY_FIND(name) library.find(#name, name);

namespace gs::net {

/// A library of the system that is opened when it is first needed, and stays open: to link one with all that it needs
/// itself can take longer than to draw a small world. Any thread, one at a time.
class SharedLibrary {
 public:
  explicit SharedLibrary(const char* name);

  /// Takes a function by its name, of the type that its header says.
  template <class Function>
  void find(const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(symbol(name));
  }
  /// What is wrong with it, if anything: nothing of it may be called then.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  [[nodiscard]] void* symbol(const char* name);

  std::string name_;
  void* handle_ = nullptr;
  std::string problem_;
};

}  // namespace gs::net

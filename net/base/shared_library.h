#pragma once

#include <string>

/// Macros for lists of functions: declare a member for each function, and find each function in `library`.
#define GHOSTSPACE_LIBRARY_MEMBER(name) decltype(&::name) name = nullptr;
#define GHOSTSPACE_LIBRARY_FIND(name) library.find(#name, name);

namespace gs::net {

/// System library that is opened at first use and stays open: linking a library with its dependencies can take longer
/// than drawing a small world. Any thread, one at a time.
class SharedLibrary {
 public:
  explicit SharedLibrary(const char* name);

  /// Finds a function by its name. Its type is that of the library's header.
  template <class Function>
  void find(const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(symbol(name));
  }
  /// Returns the error, or an empty string. After an error, no function of the library may be called.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  [[nodiscard]] void* symbol(const char* name);

  std::string name_;
  void* handle_ = nullptr;
  std::string problem_;
};

}  // namespace gs::net

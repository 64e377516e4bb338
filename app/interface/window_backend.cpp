#include "app/interface/window_backend.h"

#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

namespace gs::app {
namespace {

class WindowBackend final : public InterfaceBackend {
 public:
  explicit WindowBackend(GLFWwindow* window) : window_(window) {}
  ~WindowBackend() override {
    if (!begun_) return;
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
  }

  void begin() override {
    ImGui_ImplGlfw_InitForOpenGL(window_, false);
    ImGui_ImplOpenGL3_Init("#version 330 core");
    begun_ = true;
  }
  void begin_frame() override {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
  }
  void fonts_changed() override {
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
  void draw() override { ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData()); }

 private:
  GLFWwindow* window_;
  bool begun_ = false;
};

}  // namespace

std::unique_ptr<InterfaceBackend> make_window_backend(GLFWwindow* window) {
  return std::make_unique<WindowBackend>(window);
}

}  // namespace gs::app

// fontconfig never gives back what it learned of the system's fonts. The name is the leak sanitizer's.
extern "C" const char* __lsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig";
}  // NOLINT(bugprone-reserved-identifier)

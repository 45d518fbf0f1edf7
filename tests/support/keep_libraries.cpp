// Linked into programs that open windows, under the address sanitizer alone. What a library holds to its end counts as
// leaked once it has been unloaded, and by then nobody can tell whose it was: GLX and what it loads are unloaded when
// the window closes. So nothing is.
extern "C" int dlclose(void* /*library*/) {
  return 0;
}

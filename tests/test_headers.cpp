// Nothing but a place for the headers of GoogleTest, which all tests share precompiled (CMakeLists.txt).
int main() {}

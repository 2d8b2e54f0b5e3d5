#include <gtest/gtest.h>
int main_layer_contact_placeholder = 0;

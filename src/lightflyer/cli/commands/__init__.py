"""Commands, one a module; lab bench and missions have folders of their own beside this one."""

"""`flatrig render`: films of cranes and hands, one or several controllers side by side."""

# A control engineer with a crane of her own: can it make the move, what goes into the controller,
# what happens if the load is another, and a page for a colleague.
flatrig example tower > crane.toml
flatrig analyse crane.toml --plot move.png
flatrig analyse crane.toml --shortest --json > analysis.json
flatrig solve crane.toml --rate 100 --hold -o inputs.csv
flatrig export crane.toml --c feedforward.c
flatrig run crane.toml --controller lqr --scenario load_mass=1.2,wind=20 -o run
flatrig report crane.toml --plain --scenario load_mass=1.2 -o report.html
